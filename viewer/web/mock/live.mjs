// SPDX-License-Identifier: Apache-2.0
// A WebSocket that tells of commits, as a server with a robot would; text frames alone.
import { createHash } from 'node:crypto';
import { kLast, kStart } from './world.mjs';

const kGuid = '258EAFA5-E914-47DA-95CA-C5AB0DC85B11';

function frame(text) {
  const body = Buffer.from(text);
  const head = body.length < 126 ? Buffer.from([0x81, body.length]) : Buffer.from([0x81, 126, body.length >> 8, body.length & 255]);
  return Buffer.concat([head, body]);
}

/** The entity that is recorded while somebody looks. */
export const kRecording = 'RobotState/Proprioception/robot/joints';

/** Takes an upgraded connection and tells of one commit every `periodMs`; `committed` gets their offsets in nanoseconds. */
export function acceptLive(request, socket, committed = [], periodMs = 500) {
  const key = request.headers['sec-websocket-key'];
  if (!key) return socket.destroy();
  const accept = createHash('sha1').update(key + kGuid).digest('base64');
  socket.write(`HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Accept: ${accept}\r\n\r\n`);
  let last = kLast;
  const timer = setInterval(() => {
    last += BigInt(periodMs) * 1_000_000n;
    const offset = Number(last - kStart);
    if (offset > (committed.at(-1) ?? 0)) committed.push(offset);
    socket.write(frame(JSON.stringify({ kind: 'commit', ids: [`${kRecording}/${last}`] })));
  }, periodMs);
  const stop = () => clearInterval(timer);
  socket.on('close', stop);
  socket.on('error', stop);
  socket.on('data', (data) => { if ((data[0] & 15) === 8) socket.end(); });
}
