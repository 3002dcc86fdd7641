// SPDX-License-Identifier: Apache-2.0
// Answers the requests of the contract. The same handler serves `vite` while developing, and the
// small server of the tests.
import { kEntities, kFirst, kHorizonNs, kLast, kStart, formOf, isRecorded, lowerBound } from './world.mjs';
import { membersOf, seriesValue } from './values.mjs';
import { entityOf, linksOf, mapOf, momentAt, predicted, Refusal, similarTo, snapshotAt, splitId } from './moments.mjs';
import { depthOf, errorMap, psnr, reconstruct, scene } from './paint.mjs';
import { kRecording } from './live.mjs';
import { forgetting, nights, reflection } from './nights.mjs';
import { png } from './png.mjs';
import { tree } from './tree.mjs';

const need = (query, name) => {
  const value = query.get(name);
  if (value === null || value === '') throw new Refusal(400, 'invalid argument', `the query needs '${name}'`);
  return value;
};
const json = (value) => ({ type: 'application/json', body: JSON.stringify(value) });
const binary = (array, headers = {}) => ({ type: 'application/octet-stream', body: Buffer.from(array.buffer), headers });

function density(query) {
  const pixels = Number(need(query, 'pixels'));
  const from = Number(BigInt(need(query, 'from')) - kStart);
  const step = Number(BigInt(need(query, 'to')) - kStart - BigInt(from)) / pixels;
  const ids = query.getAll('entity');
  const out = new Uint32Array(ids.length * 3 * pixels);
  ids.forEach((id, row) => {
    const below = [...kEntities.values()].filter((entity) => entity.id === id || entity.id.startsWith(`${id}/`));
    if (below.length === 0) entityOf(id);
    for (const entity of below)
      for (let x = 0, i = lowerBound(entity.times, from); x < pixels; ++x)
        for (const end = from + (x + 1) * step; i < entity.times.length && entity.times[i] < end; ++i)
          out[(row * 3 + formOf(entity, entity.times[i])) * pixels + x] += 1;
  });
  return binary(out);
}

function series(query) {
  const entity = entityOf(need(query, 'entity'));
  const pixels = Number(need(query, 'pixels'));
  const from = Number(BigInt(need(query, 'from')) - kStart);
  const step = Number(BigInt(need(query, 'to')) - kStart - BigInt(from)) / pixels;
  const paths = query.getAll('path');
  const out = new Float32Array(paths.length * 3 * pixels).fill(NaN);
  for (let x = 0, i = lowerBound(entity.times, from); x < pixels; ++x) {
    const begin = i;
    i = lowerBound(entity.times, from + (x + 1) * step);
    // At most three snapshots of a pixel are looked at: a mock need not find every spike.
    for (let j = begin; j < i; j += Math.max(1, Math.ceil((i - begin) / 3))) {
      paths.forEach((path, p) => {
        const number = seriesValue(entity, path, entity.times[j] / 1e9);
        const at = p * 3 * pixels + x;
        if (!(out[at] <= number)) out[at] = number;
        if (!(out[at + pixels] >= number)) out[at + pixels] = number;
        out[at + 2 * pixels] = number;
      });
    }
  }
  return binary(out);
}

function image(query) {
  const { entity, time, instance } = splitId(need(query, 'id'));
  const form = query.get('form') ?? 'any';
  if (!['camera', 'hand_camera', 'depth'].includes(entity.kind)) throw new Refusal(404, 'not found', `entity '${entity.id}' has no image`);
  const eye = instance * 6 + (entity.kind === 'hand_camera' ? 24 : 0);
  const paint = (t) => (entity.kind === 'depth' ? depthOf(scene(t, eye)) : scene(t, eye));
  const headers = { 'X-Engram-Width': '128', 'X-Engram-Height': '128', ...(entity.kind === 'depth' ? { 'X-Engram-Min': '400', 'X-Engram-Max': '4200' } : {}) };
  if (form === 'predicted') {
    const horizon = Number(need(query, 'horizon'));
    const from = Number(BigInt(query.get('from') ?? time - BigInt(horizon)) - kStart);
    const pixels = reconstruct(paint((from + Math.min(horizon, 4e8)) / 1e9), 1 + Math.min(2, Math.floor(horizon / 1e9)));
    Object.assign(headers, { 'X-Engram-Source': 'predicted', 'X-Engram-Engine': 'deep', 'X-Engram-Expected-Error': '0.051', 'X-Engram-Bound': '0.097', 'X-Engram-Horizon': `${horizon}` });
    return { type: 'image/png', body: png(128, 128, pixels), headers };
  }
  const snapshot = momentAt(entity, time, 'exact');
  const offset = Number(time - kStart);
  const hasLatent = formOf(entity, offset) === 1;
  const hasRecorded = isRecorded(entity, offset);
  if (form === 'recorded' && !hasRecorded) throw new Refusal(404, 'not found', `snapshot '${snapshot.id}' is kept as latents alone: its recorded image was dropped`);
  if ((form === 'latent' || form === 'error') && !hasLatent) throw new Refusal(404, 'not found', `snapshot '${snapshot.id}' has no latents yet: no night came after it`);
  if (form === 'error' && !hasRecorded) throw new Refusal(404, 'not found', `snapshot '${snapshot.id}' has no recorded image to compare with`);
  const recorded = paint(offset / 1e9);
  const latent = hasLatent ? reconstruct(recorded) : null;
  const kind = form === 'any' ? (hasRecorded ? 'recorded' : 'latent') : form;
  Object.assign(headers, { ETag: `"${time}-${kind}"`, 'Cache-Control': 'private, max-age=31536000, immutable', 'X-Engram-Source': kind === 'recorded' ? kind : 'reconstructed' });
  if (latent) Object.assign(headers, { 'X-Engram-Model': `${entity.kind}-0007`, 'X-Engram-PSNR': psnr(recorded, latent).toFixed(2) });
  if (kind !== 'error') headers['X-Engram-Bytes'] = kind === 'latent' ? '412' : '19840';
  if (kind === 'error') headers['X-Engram-Gain'] = '8';
  const pixels = kind === 'error' ? errorMap(recorded, latent, 8) : kind === 'latent' ? latent : recorded;
  return { type: 'image/png', body: png(128, 128, pixels), headers };
}

/** Points of a wavy wall 1.5 m ahead, one per pixel of the depth image, or every n-th. */
function cloud(query) {
  const { entity } = splitId(need(query, 'id'));
  if (entity.kind !== 'depth') throw new Refusal(404, 'not found', `entity '${entity.id}' has no depth image and no rows of points`);
  const [fx, fy, cx, cy] = ['fx', 'fy', 'cx', 'cy'].map((name) => Number(need(query, name)));
  const total = 128 * 128;
  const count = Math.min(total, Number(query.get('max') ?? 500_000));
  const points = new Float32Array(3 * count);
  for (let i = 0; i < count; ++i) {
    const pixel = Math.floor((i * total) / count);
    const [u, v] = [pixel % 128, Math.floor(pixel / 128)];
    const z = 1.5 + 0.2 * Math.sin(u / 9) * Math.cos(v / 11);
    points.set([((u - cx) / fx) * z, ((v - cy) / fy) * z, z], 3 * i);
  }
  return binary(points, { 'X-Engram-Source': 'recorded', 'X-Engram-Points': `${count}`, 'X-Engram-Total': `${total}` });
}

/** An entity with what was committed since the memory was opened. */
function grown(entity, committed) {
  if (entity.id !== kRecording || committed.length === 0) return entity;
  const times = new Float64Array(entity.times.length + committed.length);
  times.set(entity.times);
  times.set(committed, entity.times.length);
  return { ...entity, times };
}

function predict(query, committed) {
  const entity = grown(entityOf(need(query, 'entity')), committed);
  const at = query.get('at');
  const index = at === null ? entity.times.length - 1 : lowerBound(entity.times, Number(BigInt(at) - kStart) + 1) - 1;
  if (index < 0) throw new Refusal(404, 'not found', `entity '${entity.id}' has nothing to predict from at ${at}`);
  return json(need(query, 'horizon').split(',').map((horizon) => predicted(entity, index, Number(horizon))));
}

function step(query, committed) {
  const entity = grown(entityOf(need(query, 'entity')), committed);
  const offset = Number(BigInt(need(query, 'at')) - kStart);
  const by = Number(need(query, 'by'));
  const here = lowerBound(entity.times, by > 0 ? offset + 1 : offset);
  const index = Math.max(0, Math.min(entity.times.length - 1, by > 0 ? here + by - 1 : here + by));
  return json({ time: `${kStart + BigInt(entity.times[index])}` });
}

function find(query) {
  const text = (query.get('text') ?? '').toLowerCase();
  const max = Number(query.get('max') ?? 20);
  const found = [...kEntities.keys()].filter((id) => id.toLowerCase().includes(text));
  return json({ found: found.slice(0, max), more: found.length > max });
}

function similar(query) {
  const { entity, time } = splitId(need(query, 'id'));
  return json({ found: similarTo(entity, time, Number(query.get('k') ?? 10)) });
}

function map(query) {
  return json(mapOf(entityOf(need(query, 'entity')), Number(query.get('max') ?? 2000)));
}

/** PSNR of both forms, over at most `sample` snapshots that are spread evenly. */
function quality(query) {
  const entity = entityOf(need(query, 'entity'));
  if (!entity.kind.includes('camera')) throw new Refusal(409, 'failed precondition', `entity '${entity.id}' has no image, and the quality of numbers is not told`);
  const both = entity.times.filter((offset) => formOf(entity, offset) === 1 && isRecorded(entity, offset));
  const count = Math.min(Number(query.get('sample') ?? 200), both.length, 64);
  const found = Array.from({ length: count }, (_, i) => both[Math.floor((i * both.length) / count)]).map((offset) => {
    const recorded = scene(offset / 1e9, entity.kind === 'hand_camera' ? 24 : 0);
    return { id: `${entity.id}/${kStart + BigInt(offset)}`, psnr: Math.round(psnr(recorded, reconstruct(recorded)) * 100) / 100 };
  }).sort((a, b) => a.psnr - b.psnr);
  const [low, step] = [Math.floor(found[0].psnr * 10) / 10, 0.1];
  const counts = new Array(Math.floor((found.at(-1).psnr - low) / step + 1e-9) + 1).fill(0);
  for (const one of found) counts[Math.floor((one.psnr - low) / step + 1e-9)] += 1;
  return json({ entity: entity.id, low, step, counts, unknown: 0, compared: count, asked: Math.min(Number(query.get('sample') ?? 100), both.length), worst: found.slice(0, 20) });
}

function links(query) {
  const { entity, time } = splitId(need(query, 'id'));
  return json(linksOf(entity, time));
}

function textQuery(query) {
  const [names, selector = 'latest'] = need(query, 'q').split('@').map((part) => part.trim());
  const levels = names.split('/');
  const matching = [...kEntities.values()].filter((entity) => levels.every((level, i) => level === '' || new RegExp(`^(?:${level})$`).test(entity.id.split('/')[i] ?? '')));
  if (matching.length === 0) throw new Refusal(404, 'not found', `query '${names} @ ${selector}': no entity matches; there are ${[...kEntities.keys()].slice(0, 5).join(', ')}, ...`);
  return json({ ids_only: false, entities: matching.map((entity) => ({ id: entity.id, snapshots: [snapshotAt(entity, entity.times.length - 1)] })) });
}

const info = () => json({
  name: 'engram', version: '1.4.0', stores: [{ name: 'kitchen.engram', path: '/data/kitchen.engram' }], first: `${kFirst}`, last: `${kLast}`, entities: kEntities.size,
  snapshots: [...kEntities.values()].reduce((sum, entity) => sum + entity.times.length, 0), is_live: false, max_horizon_ns: `${kHorizonNs}`,
});

const routes = {
  memories: () => json({ memories: [{ name: 'kitchen.engram', path: '/data/kitchen.engram', is_live: false }] }),
  info, density, series, image, cloud, predict, step, nights, find, similar, links, map, quality, reflection, forgetting,
  query: textQuery,
  tree: (query) => json(tree(query.get('under') ?? '', Number(query.get('depth') ?? 1))),
  members: (query) => json({ members: membersOf(entityOf(need(query, 'entity'))) }),
  moment: (query, committed) => json(momentAt(grown(entityOf(need(query, 'entity')), committed), BigInt(need(query, 'at')), query.get('which') ?? 'at-or-before')),
};

/** Answers a URL below /api/: {status, type, body, headers}. `committed` are offsets of what came since. */
export function answer(url, committed = []) {
  const route = routes[url.pathname.slice('/api/'.length)];
  try {
    if (!route) throw new Refusal(404, 'not found', `nothing is at ${url.pathname}`);
    return { status: 200, headers: {}, ...route(url.searchParams, committed) };
  } catch (error) {
    const refusal = error instanceof Refusal ? error : new Refusal(400, 'invalid argument', String(error.message));
    return { status: refusal.status, type: 'application/json', headers: {}, body: JSON.stringify({ error: { code: refusal.code, message: refusal.message } }) };
  }
}
