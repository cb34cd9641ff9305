// Runs a program of the preset "wasm": node scripts/wasi.mjs PROGRAM.wasm [ARGUMENT...]. It has the
// console and all files; its exit status is node's.
import { readFileSync } from 'node:fs';
import { setFlagsFromString } from 'node:v8';
import { WASI } from 'node:wasi';

// Node 20 and 22 end with a segmentation fault where V8 calls WASI directly (nodejs/node issue 53087).
setFlagsFromString('--no-turbo-fast-api-calls');

const args = process.argv.slice(2);
const wasi = new WASI({ version: 'preview1', args, env: process.env, preopens: { '/': '/' }, returnOnExit: true });
const program = await WebAssembly.compile(readFileSync(args[0]));
const imports = { wasi_snapshot_preview1: wasi.wasiImport };
process.exitCode = wasi.start(await WebAssembly.instantiate(program, imports));
