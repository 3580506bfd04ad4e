// Runs a WebAssembly program of the firmware crate: node run.mjs PROGRAM.wasm
import { readFile } from "node:fs/promises";

let report = "";
const put = (byte) => { report += String.fromCharCode(byte); };
const module = await readFile(process.argv[2]);
// A program from which a panic can be reached imports the function that is not there, and fails here.
const { instance } = await WebAssembly.instantiate(module, { host: { put } });
instance.exports.run();
process.stdout.write(report);
