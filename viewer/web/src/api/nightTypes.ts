// SPDX-License-Identifier: Apache-2.0
// What the gateway tells of nights, reflections and of what forgetting would do.
import * as d from './decode';

const count = d.withDefault(d.number, 0);
const text = d.withDefault(d.string, '');

const night = d.object({
  work: d.oneOf('consolidate', 'forget'),
  began: d.time,
  ended: d.time,
  failure: text,
  bytes_before: count,
  bytes_after: count,
  entities: d.list(d.object({
    id: d.string, skipped: text, learned: count, encoded: count, waiting: count, dropped: count, forgotten: count, faded: count, bytes_before: count, bytes_after: count,
    psnr: d.optional(d.number), min_psnr: d.optional(d.number), models_added: d.withDefault(d.list(d.number), []), models_removed: d.withDefault(d.list(d.number), []),
  })),
});
export type Night = d.Of<typeof night>;
export type NightEntity = Night['entities'][number];

export const nights = d.object({
  entities: d.list(d.object({
    id: d.string,
    raw_bytes: count,
    stored_bytes: count,
    latent_bytes: count,
    model_bytes: count,
    snapshots: count,
    psnr_mean_over_images_db: d.optional(d.number),
    psnr: d.optional(d.object({ mean: d.optional(d.number), bins: d.withDefault(d.list(d.number), []), counts: d.withDefault(d.list(d.number), []) })),
  })),
  /** The newest first. */
  nights: d.withDefault(d.list(night), []),
  unreadable: count,
  more: d.withDefault(d.bool, false),
});
export type Nights = d.Of<typeof nights>;

const finding = d.object({
  kind: d.string, severity: d.string, entity: d.string, member: text, first_snapshot: d.string, last_snapshot: text, count: d.withDefault(d.number, 1), found: text, expected: text,
});
export type Finding = d.Of<typeof finding>;

export const reflection = d.object({
  time: d.time,
  /** When reflections were recorded, the newest last. */
  times: d.withDefault(d.list(d.time), []),
  is_recorded: d.withDefault(d.bool, true),
  findings: d.list(finding),
  rates: d.withDefault(d.list(d.object({ skill: d.string, by: text, name: text, runs: count, successes: count, failures: count, stops: count, low: count, high: d.withDefault(d.number, 1), duration_s: count })), []),
  chains: d.withDefault(d.list(d.object({ steps: d.list(d.string), count: count })), []),
});
export type Reflection = d.Of<typeof reflection>;

const counts = d.withDefault(d.list(d.number), []);
const reasons: d.Decoder<Record<string, number>> = (value, path) => {
  if (typeof value !== 'object' || value === null || Array.isArray(value)) throw new d.DecodeError(path, value, 'a dict of counts');
  return Object.fromEntries(Object.entries(value).map(([reason, one]) => [reason, d.number(one, `${path}.${reason}`)]));
};

export const forgetPlan = d.object({
  config: d.string,
  from: d.time,
  to: d.time,
  bins: d.number,
  plan: d.object({
    snapshots: count, freed_bytes: count, fading: count, faded_bytes: count, fades_for_quota: d.withDefault(d.bool, false), store_bytes: count, free_disk_bytes: count,
    quota_missing_bytes: count, not_sealed_yet: count, notes: d.withDefault(d.list(d.string), []),
  }),
  left_out: count,
  left_out_stays: count,
  entities: d.list(d.object({
    id: d.string, forgotten: count, reasons: d.withDefault(reasons, {}), freed_bytes: count, faded_bytes: count, stays: count, protected: count, not_sealed_yet: count,
    fading: d.withDefault(d.list(d.object({ form: d.string, psnr: d.optional(d.number), snapshots: count })), []), fading_reasons: d.withDefault(reasons, {}),
    lane: d.optional(d.object({ stays: counts, fades: counts, gone: counts })),
  })),
});
export type ForgetPlan = d.Of<typeof forgetPlan>;
export type PlannedEntity = ForgetPlan['entities'][number];

export const calledOff = d.object({ called_off: d.bool });
