// SPDX-License-Identifier: Apache-2.0
// Prints what the page weighs gzipped, and fails above the bars of README.md: what the first
// transfer takes, and what it takes once three.js is there.
import { readdirSync, readFileSync } from 'node:fs';
import { gzipSync } from 'node:zlib';

const kFirstBar = 120_000;
const kAllBar = 350_000;
const dist = new URL('../dist/', import.meta.url);
const weigh = (path) => gzipSync(readFileSync(new URL(path, dist)), { level: 9 }).length;

const html = readFileSync(new URL('index.html', dist), 'utf8');
if (/<script(?![^>]*\bsrc=)|<style|\sstyle=/.test(html)) {
  console.error('index.html has an inline script or style, which the policy of the page forbids');
  process.exitCode = 1;
}
const rows = [['index.html', weigh('index.html'), true]];
for (const name of readdirSync(new URL('assets/', dist)).sort())
  rows.push([`assets/${name}`, weigh(`assets/${name}`), html.includes(`/assets/${name}`)]);
let first = 0;
let all = 0;
for (const [name, bytes, isFirst] of rows) {
  all += bytes;
  if (isFirst) first += bytes;
  console.log(`${String(bytes).padStart(8)} B gzip  ${isFirst ? 'first' : 'later'}  ${name}`);
}
console.log(`first transfer ${(first / 1000).toFixed(1)} kB of ${kFirstBar / 1000}, with 3-D ${(all / 1000).toFixed(1)} kB of ${kAllBar / 1000}`);
if (first > kFirstBar || all > kAllBar) {
  console.error('the page is larger than it may be');
  process.exitCode = 1;
}
