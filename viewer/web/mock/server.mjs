// SPDX-License-Identifier: Apache-2.0
// Serves the built page and the imagined memory as the gateway does: token, cookie, strict CSP.
//   node mock/server.mjs [--port 8617]
import { createServer } from 'node:http';
import { randomBytes } from 'node:crypto';
import { readFileSync, readdirSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { answer } from './handler.mjs';
import { acceptLive } from './live.mjs';

const kDist = new URL('../dist/', import.meta.url);
const kTypes = { js: 'text/javascript', css: 'text/css', svg: 'image/svg+xml', html: 'text/html; charset=utf-8', woff2: 'font/woff2' };
export const kPolicy = "default-src 'self'; img-src 'self' blob: data:; style-src 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'";

/** Files come from a table that is made once, so no path of a request reaches the disk. */
function assets() {
  const table = new Map();
  for (const name of readdirSync(new URL('assets/', kDist))) table.set(`/assets/${name}`, readFileSync(new URL(`assets/${name}`, kDist)));
  return table;
}

/** Starts a server; `intercept(url)` may give an answer of its own, for tests of what goes wrong. */
export async function startMock({ port = 0, intercept = () => null, delayMs = 0 } = {}) {
  const token = randomBytes(12).toString('hex');
  const table = assets();
  const page = readFileSync(new URL('index.html', kDist));
  const state = { intercept, delayMs, requests: [], committed: [] };
  const server = createServer(async (request, response) => {
    const url = new URL(request.url, 'http://127.0.0.1');
    const send = (status, headers, body) => response.writeHead(status, headers).end(body);
    if (url.pathname === '/' && url.searchParams.get('token') === token) {
      url.searchParams.delete('token');
      return send(303, { Location: `/${url.search}`, 'Set-Cookie': `engram_viewer=${token}; HttpOnly; SameSite=Strict; Path=/` });
    }
    if (!(request.headers.cookie ?? '').includes(token)) return send(401, { 'Content-Type': 'text/plain' }, 'open the address that engram view printed');
    if (url.pathname === '/') return send(200, { 'Content-Type': kTypes.html, 'Content-Security-Policy': kPolicy, 'Cache-Control': 'no-store' }, page);
    if (table.has(url.pathname)) return send(200, { 'Content-Type': kTypes[url.pathname.split('.').at(-1)] ?? 'application/octet-stream' }, table.get(url.pathname));
    if (!url.pathname.startsWith('/api/')) return send(404, { 'Content-Type': 'text/plain' }, 'nothing here');
    state.requests.push(url.pathname + url.search);
    if (state.delayMs > 0) await new Promise((done) => setTimeout(done, state.delayMs));
    const { status, type, body, headers } = state.intercept(url) ?? answer(url, state.committed);
    send(status, { 'Content-Type': type, 'Cache-Control': 'no-store', ...headers }, body);
  });
  server.on('upgrade', (request, socket) => acceptLive(request, socket, state.committed));
  await new Promise((done) => server.listen(port, '127.0.0.1', done));
  const address = `http://127.0.0.1:${server.address().port}/`;
  return { url: `${address}?token=${token}`, address, state, close: () => new Promise((done) => { server.closeAllConnections(); server.close(done); }) };
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const at = process.argv.indexOf('--port');
  const mock = await startMock({ port: at > 0 ? Number(process.argv[at + 1]) : 8617 });
  console.log(mock.url);
}
