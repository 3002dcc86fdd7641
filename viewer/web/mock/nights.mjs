// SPDX-License-Identifier: Apache-2.0
// What nights did to the imagined memory, what reflections found in it, and what forgetting would do.
import { kEntities, kFirst, kLast, kStart, formOf, isRecorded, lowerBound } from './world.mjs';
import { Refusal } from './moments.mjs';

const json = (value) => ({ type: 'application/json', body: JSON.stringify(value) });
const kHour = 3_600_000_000_000n;
const storedBytes = (entity) => Math.round(entity.times.filter((offset) => isRecorded(entity, offset)).length * entity.bytes * 0.38);

/** Three nights that learned, one that was stopped, and one run of forgetting. */
function records() {
  const learning = [...kEntities.values()].filter((entity) => entity.hasModel);
  const one = (began, minutes, before, after, entities, more = {}) => ({
    work: 'consolidate', began: `${began}`, ended: `${began + BigInt(minutes) * 60_000_000_000n}`, failure: '', bytes_before: before, bytes_after: after, entities, ...more,
  });
  const part = (entity, share, version, more = {}) => ({
    id: entity.id, skipped: '', learned: Math.round(entity.times.length * share * 0.8), encoded: Math.round(entity.times.length * share), waiting: 0, dropped: Math.round(entity.times.length * share * 0.7), forgotten: 0, faded: 0,
    bytes_before: Math.round(entity.bytes * entity.times.length * 0.38 * share), bytes_after: Math.round(entity.bytes * entity.times.length * 0.02 * share),
    models_added: [version], models_removed: version > 1 ? [version - 1] : [], ...(entity.kind.includes('camera') ? { psnr: 36.21, min_psnr: 35.02 } : {}), ...more,
  });
  return [
    one(kLast + 30n * kHour, 1, 9_800_000, 7_100_000, [{ ...part(learning[0], 0, 4), models_added: [], models_removed: [], learned: 0, encoded: 0, dropped: 0, faded: 2210, min_psnr: 31.8 }, { ...part(learning[4], 0, 4), models_added: [], models_removed: [], learned: 0, encoded: 0, dropped: 0, forgotten: 5120 }], { work: 'forget' }),
    one(kLast + 16n * kHour, 210, 31_400_000, 9_800_000, learning.map((entity) => part(entity, 0.5, 3))),
    one(kLast + 15n * kHour, 4, 31_400_000, 31_400_000, [{ ...part(learning[0], 0, 2), models_added: [], models_removed: [], waiting: 4800, skipped: 'the time was over before anything was encoded', dropped: 0 }], { failure: 'stopped by SIGTERM' }),
    one(kLast - 8n * kHour, 185, 240_000_000, 31_400_000, learning.map((entity) => part(entity, 0.3, 1))),
  ];
}

export function nights() {
  const rows = [...kEntities.values()].map((entity) => {
    const latent = entity.times.filter((offset) => formOf(entity, offset) === 1).length;
    return {
      id: entity.id, snapshots: entity.times.length, raw_bytes: entity.times.length * entity.bytes, stored_bytes: storedBytes(entity),
      latent_bytes: Math.round(latent * entity.bytes * 0.006), model_bytes: latent > 0 ? 1_420_000 : 0,
      ...(entity.kind.includes('camera') ? { psnr: { mean: 31.4, min: 26.1, max: 36.8, bins: [26, 27, 28, 29, 30, 31, 32, 33, 34, 35, 36], counts: [3, 18, 70, 190, 520, 930, 1100, 640, 210, 60, 8] } } : {}),
    };
  });
  return json({ entities: rows, nights: records(), unreadable: 0, more: false });
}

const at = (id, seconds) => { const entity = kEntities.get(id); return `${id}/${kStart + BigInt(entity.times[lowerBound(entity.times, seconds * 1e9)])}`; };
const finding = (kind, severity, entity, from, to, found, expected, more = {}) =>
  ({ kind, severity, entity, member: '', first_snapshot: at(entity, from), last_snapshot: at(entity, to), found, expected, count: 1, ...more });

/** Two reflections were recorded: after the first night, and after the last one. */
export function reflection(query) {
  if (query.get('stop') === '1') return json({ called_off: true });
  const times = [kLast - 4n * kHour, kLast + 21n * kHour];
  const isLook = query.get('look') === '1';
  const before = query.get('at') === null ? times.at(-1) : times.findLast((time) => time <= BigInt(query.get('at')));
  if (!isLook && before === undefined) throw new Refusal(404, 'not found', 'no reflection was recorded before this moment');
  const findings = [
    finding('gap', 'fault', 'Vision/RGB/head/stereo', 496, 552, 'a pause of 55 s', 'a step of 50 ms'),
    finding('broken-action', 'fault', 'Skills/Actions/robot/pick', 660, 680, 'a begin without an end', 'an end within 9.2 s'),
    finding('spike', 'fault', 'RobotState/Proprioception/robot/joints', 301, 301, '2.41 rad away and back', 'steps of 0.04 rad', { member: 'positions[3]' }),
    finding('dead-link', 'note', 'Skills/Actions/robot/place', 719, 719, 'a link to a snapshot that was forgotten', 'a snapshot that is there', { member: 'object', count: 4 }),
    finding('time-shift', 'note', 'RobotState/Localization/robot/platform', 100, 900, 'motion 80 ms late', 'motion at the same time'),
  ];
  const rate = (skill, by, name, runs, successes, low, high) => ({ skill, by, name, runs, successes, failures: runs - successes, stops: 0, low, high, duration_s: 4.2 });
  return json({
    time: `${isLook ? kLast + 40n * kHour : before}`, times: isLook ? [] : times.map(String), is_recorded: !isLook, findings: !isLook && before === times[0] ? findings.slice(0, 1) : findings,
    rates: [rate('pick', 'all', '', 92, 78, 0.76, 0.91), rate('pick', 'hand', 'left', 46, 41, 0.77, 0.95), rate('place', 'all', '', 78, 76, 0.91, 0.99)],
    chains: [{ steps: ['pick failure', 'navigate success', 'pick success'], count: 9 }],
  });
}

const kUnits = { s: 1, min: 60, h: 3600, d: 86_400 };
const kSizes = { B: 1, kB: 1e3, MB: 1e6, GB: 1e9 };

/** The seconds before the last snapshot that a field means, or undefined. */
function agoOf(query, name) {
  const text = query.get(name);
  if (text === null) return undefined;
  const [, number, unit] = /^(\d+(?:\.\d+)?)(s|min|h|d)$/.exec(text) ?? [];
  if (unit === undefined) throw new Refusal(400, 'invalid argument', `parameter '${name}': found '${text}', needs a duration such as 12h or 7d`);
  return Number(number) * kUnits[unit];
}

/** Only what tests ask for: age, fading by age, and names; of a configuration the age alone. */
export function forgetting(query) {
  if (query.get('stop') === '1') return json({ called_off: true });
  const pasted = query.get('config');
  const parts = [...query].filter(([name]) => !['page', 'config', 'match'].includes(name)).map(([name, value]) => `${name}: ${value}`);
  const config = pasted ?? `forget:\n  rules:\n    - {${query.get('match') ? `match: '${query.get('match')}', ` : ''}${parts.join(', ')}}\n`;
  if (pasted !== null && !/^forget:/m.test(pasted)) throw new Refusal(400, 'invalid argument', "policy:1: has no key 'forget', needs one");
  const end = Number(kLast - kStart) / 1e9;
  const age = pasted === null ? agoOf(query, 'older_than') : agoOf(new URLSearchParams({ older_than: /older_than: (\w+)/.exec(pasted)?.[1] ?? '' }), 'older_than');
  const fade = agoOf(query, 'fade_after');
  const quota = query.get('max_bytes');
  if (quota !== null && !(/^[\d.]+(B|kB|MB|GB)$/.exec(quota)?.[1] in kSizes)) throw new Refusal(400, 'invalid argument', `parameter 'max_bytes': found '${quota}', needs a size such as 500MB or 20GiB`);
  if (pasted === null && age === undefined && fade === undefined && quota === null) throw new Refusal(400, 'invalid argument', "nothing says what is to go: needs 'older_than', 'unread_for', 'keep', 'fade_after' or 'max_bytes'");
  const levels = (query.get('match') ?? '').split('/');
  const bins = 240;
  const [from, to] = [Number(kFirst - kStart), Number(kLast + 1n - kStart)];
  const entities = [...kEntities.values()].map((entity) => {
    const isMatching = levels.every((level, i) => level === '' || new RegExp(`^(?:${level})$`).test(entity.id.split('/')[i] ?? ''));
    const lane = { stays: new Array(bins).fill(0), fades: new Array(bins).fill(0), gone: new Array(bins).fill(0) };
    const sums = { stays: 0, fades: 0, gone: 0 };
    entity.times.forEach((offset, i) => {
      const ago = end - offset / 1e9;
      const isNewest = i === entity.times.length - 1;
      const what = isMatching && !isNewest && age !== undefined && ago > age ? 'gone' : isMatching && !isNewest && fade !== undefined && ago > fade && formOf(entity, offset) === 1 && entity.kind.includes('camera') ? 'fades' : 'stays';
      sums[what] += 1;
      lane[what][Math.floor(((offset - from) * bins) / (to - from))] += 1;
    });
    const share = storedBytes(entity) / entity.times.length;
    return {
      id: entity.id, forgotten: sums.gone, reasons: sums.gone > 0 ? { [`older than ${query.get('older_than') ?? 'told'}`]: sums.gone } : {}, freed_bytes: Math.round(sums.gone * share), faded_bytes: Math.round(sums.fades * share * 0.6),
      fading: sums.fades > 0 ? [{ form: 'psnr', psnr: Number(query.get('fade_psnr') ?? 32), snapshots: sums.fades }] : [], fading_reasons: sums.fades > 0 ? { [`to 32 dB: older than ${query.get('fade_after')}`]: sums.fades } : {},
      stays: sums.stays + sums.fades, protected: 0, not_sealed_yet: 0, lane,
    };
  }).sort((a, b) => b.freed_bytes + b.faded_bytes - a.freed_bytes - a.faded_bytes);
  const sum = (of) => entities.reduce((total, entity) => total + of(entity), 0);
  return json({
    config, from: `${kFirst}`, to: `${kLast + 1n}`, bins, left_out: 0, left_out_stays: 0, entities,
    plan: {
      snapshots: sum((one) => one.forgotten), freed_bytes: sum((one) => one.freed_bytes), fading: sum((one) => one.fading[0]?.snapshots ?? 0), faded_bytes: sum((one) => one.faded_bytes), fades_for_quota: false,
      store_bytes: 1_240_000_000, free_disk_bytes: 9e11, quota_missing_bytes: quota === null ? 0 : 1000, not_sealed_yet: 0, notes: ['2 models may have learned from what goes: --erase replaces them'],
    },
  });
}
