#!/bin/bash
# inter.sh A B GROUPS METHOD REPEATS ROUNDS [VERBOSE]: interleaved; best time of all rounds
A=$1; B=$2; G=$3; M=$4; R=$5; N=$6; rm -f /tmp/rj.$$.*
for i in $(seq $N); do ./bin/$A $G $M $R >> /tmp/rj.$$.a 2>>/tmp/rj.$$.e; ./bin/$B $G $M $R >> /tmp/rj.$$.b 2>>/tmp/rj.$$.e; done
python3 - /tmp/rj.$$.a /tmp/rj.$$.b <<'P'
import sys
for p in sys.argv[1:]:
    d={}
    for l in open(p):
        f=l.strip().split("|"); k=tuple(f[:2])
        if len(f)<11: continue
        if k not in d or float(f[8])<float(d[k][8]): d[k]=f
    open(p,"w").write("".join("|".join(f)+"\n" for f in d.values()))
P
python3 compare.py /tmp/rj.$$.a /tmp/rj.$$.b $7; cat /tmp/rj.$$.e | head -3
