// Compiles binding.c with Node's own headers and with the midair that pkg-config finds.
'use strict';

const { execFileSync } = require('node:child_process');
const { existsSync } = require('node:fs');
const path = require('node:path');

const headers = path.resolve(process.execPath, '../../include/node');
if (!existsSync(path.join(headers, 'node_api.h'))) {
  console.error(`build: ${headers} has no node_api.h: install Node's headers (Debian: libnode-dev)`);
  process.exit(1);
}
const flags = execFileSync('pkg-config', ['--cflags', '--libs', 'midair'], { encoding: 'utf8' }).trim().split(/\s+/);
const own = flags.filter((flag) => flag.startsWith('-L')).map((flag) => `-Wl,-rpath,${flag.slice(2)}`);
const shared = ['-std=c99', '-O2', '-Wall', '-Wextra', '-fPIC', '-shared'];
const files = [path.join(__dirname, 'binding.c'), '-o', path.join(__dirname, 'midair.node')];
execFileSync('cc', [...shared, `-I${headers}`, ...files, ...flags, ...own], { stdio: 'inherit' });
