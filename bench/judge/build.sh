#!/bin/sh
# build.sh NAME [TREE]: builds the judge of a checkout's solvers to bin/NAME
cd .; python3 sync.py x ${2:-../..} && cd tree && CARGO_TARGET_DIR=./target cargo build --release --offline -q > ../build.log 2>&1; grep -E "^error" -A8 ../build.log | head -${3:-80}
grep -q "^error" ../build.log || { mkdir -p ../bin; cp ../target/release/judge ../bin/$1; ls -la ../bin/$1; }; date
