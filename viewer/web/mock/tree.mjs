// SPDX-License-Identifier: Apache-2.0
// The levels of the imagined memory, with what each of them holds.
import { formOf, isRecorded, kEntities, kStart } from './world.mjs';
import { membersOf } from './values.mjs';

const kLevels = ['memory', 'core', 'provider', 'entity'];
const counts = new Map();

/** Counts of an entity by form; made once, because the times do not change. */
function formsOf(entity) {
  if (!counts.has(entity.id)) {
    const forms = { recorded: 0, latent: 0, augmented: 0 };
    let stored = 0;
    for (const offset of entity.times) {
      forms[['recorded', 'latent', 'augmented'][formOf(entity, offset)]] += 1;
      if (isRecorded(entity, offset)) stored += 1;
    }
    counts.set(entity.id, { forms, stored });
  }
  return counts.get(entity.id);
}

function node(id, level, below) {
  const last = (entity) => entity.times[entity.times.length - 1];
  const common = {
    name: id.split('/').at(-1), id, level: kLevels[level], entities: below.length,
    snapshots: below.reduce((sum, entity) => sum + entity.times.length, 0),
    first: `${kStart + BigInt(Math.min(...below.map((entity) => entity.times[0])))}`,
    last: `${kStart + BigInt(Math.max(...below.map(last)))}`,
  };
  if (level < 3) return common;
  const [entity] = below;
  const { forms, stored } = formsOf(entity);
  return {
    ...common, forms, kinds: [...new Set(membersOf(entity).map((member) => member.kind))],
    raw_bytes: entity.bytes * entity.times.length, stored_bytes: Math.round(stored * entity.bytes * 0.38),
    latent_bytes: Math.round(forms.latent * entity.bytes * 0.006), model_bytes: entity.hasModel ? 1_420_000 : 0, models: entity.hasModel ? 7 : 0,
  };
}

/** The children of an ID, and theirs as deep as is asked for. */
export function tree(under, depth) {
  const prefix = under === '' ? [] : under.split('/');
  const level = prefix.length;
  const groups = new Map();
  for (const entity of kEntities.values()) {
    const parts = entity.id.split('/');
    if (level > 3 || prefix.some((name, i) => parts[i] !== name)) continue;
    const id = parts.slice(0, level + 1).join('/');
    groups.set(id, [...(groups.get(id) ?? []), entity]);
  }
  const children = [...groups].map(([id, below]) => ({
    ...node(id, level, below),
    ...(depth > 1 && level < 3 ? { children: tree(id, depth - 1).children } : {}),
  }));
  return { under, children };
}
