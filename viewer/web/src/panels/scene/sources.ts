// SPDX-License-Identifier: Apache-2.0
// What the scene asks the memory: which entities, and only those of which something changed.
import { createMemo } from 'solid-js';
import { ApiError, getJson } from '../../api/client';
import { Turns } from '../../api/turns';
import { moment as momentDecoder, moments, type Moment, type TreeNode } from '../../api/types';
import { parseId } from '../../state/ids';
import { kDescriptionEntities, kJointEntities } from '../../state/joints';
import { entities, info, newsOf, nodeOf } from '../../state/store';
import { frameOf, kHalfView } from './frame';
import { KeptMoments, type Wanted } from './kept';
import { posesIn, sizeIn, type Placed } from './poses';

const kMaxEntities = 64;
/** Nobody tells what is written to a store, or forgotten on a server. */
const kMaxAgeMs = { store: 2_000, live: 60_000 } as const;

export type Role = 'place' | 'cloud' | 'description' | 'joints' | 'base' | 'floor' | 'plan' | 'drive' | 'location';

const kBase = /platform|localization|base/i;

/** What navigation keeps (docs/navigation.md); their poses are drawn as what they mean. */
const kNavigation: Record<string, Role> = { CostMap: 'floor', Plan: 'plan', Event: 'drive', Location: 'location' };

/** What the scene wants of an entity, by its kinds, or by its name where these are not known. */
export function rolesOf(node: Pick<TreeNode, 'id' | 'kinds'>): readonly Role[] {
  const [memory, core] = node.id.split('/');
  const navigation = memory === 'Navigation' ? kNavigation[core ?? ''] : undefined;
  if (navigation) return [navigation];
  const has = (kind: string) => node.kinds?.includes(kind) ?? true;
  const roles: Role[] = [];
  if (has('text') && kDescriptionEntities.test(node.id)) roles.push('description');
  if (has('number') && kJointEntities.test(node.id)) roles.push('joints');
  if ((has('number') || has('pose')) && kBase.test(node.id)) roles.push('base');
  if (has('depth') || has('cloud')) roles.push('cloud');
  if (has('pose') || roles.includes('base')) roles.push('place');
  return roles;
}

export interface Found {
  readonly id: string;
  readonly moment: Moment;
}
export const valueOf = (found: Found): unknown => found.moment.instances[0]?.data;

/** The first link of a value whose key is like this. */
function linkIn(value: unknown, key: RegExp): string | undefined {
  for (const [name, part] of Object.entries(typeof value === 'object' && value !== null ? value : {}))
    if (key.test(name) && typeof (part as { $link?: unknown } | null)?.$link === 'string') return (part as { $link: string }).$link;
  return undefined;
}

/** Asks for moments of a scene, at most four at once, each answer as long as it holds. */
export function createSources() {
  // Predictions may take seconds, because they learn first; what was recorded does not wait for them.
  const turns = { recorded: new Turns(4), predicted: new Turns(2) } as const;
  const load = (wanted: Wanted, signal: AbortSignal): Promise<Moment | null> => (/^(predict|ahead)/.test(wanted.which) ? turns.predicted : turns.recorded).run(async () => {
    const { entity, at, which } = wanted;
    try {
      if (!which.startsWith('ahead ')) return await getJson('moment', { entity, at, which }, momentDecoder, signal);
      return (await getJson('predict', { entity, at, horizon: which.slice('ahead '.length) }, moments, signal))[0] ?? null;
    } catch (error) {
      // An entity that was not there yet, or cannot be predicted, is no error of the scene.
      if (error instanceof ApiError && ['not found', 'failed precondition', 'invalid argument'].includes(error.code)) return null;
      throw error;
    }
  }, signal);
  const kept = new KeptMoments(load);
  const roles = createMemo(() => {
    const all = entities().map((node) => ({ id: node.id, roles: rolesOf(node) })).filter((one) => one.roles.length > 0);
    // A robot comes first where there are too many things or places.
    const isOfRobot = (one: { roles: readonly Role[] }) => Number(one.roles.some((role) => role !== 'place' && role !== 'cloud' && role !== 'location'));
    return all.sort((a, b) => isOfRobot(b) - isOfRobot(a)).slice(0, kMaxEntities);
  });
  const idsOf = (role: Role): string[] => roles().filter((one) => one.roles.includes(role)).map((one) => one.id);
  const maxAge = () => (info()?.is_live ? kMaxAgeMs.live : kMaxAgeMs.store);

  /** Moments of these entities; `which` may differ by entity. Reads signals before it waits. */
  const ask = (ids: readonly string[], at: bigint, whichOf: (id: string) => string) => {
    const wanted = ids.map((entity) => ({ entity, at, which: whichOf(entity), news: newsOf(entity) }));
    const age = maxAge();
    return async (signal: AbortSignal): Promise<Found[]> => {
      const all = await Promise.all(wanted.map(async (one): Promise<Found | null> => {
        const moment = await kept.ask(one, age, signal).catch((error: unknown) => { if (signal.aborted) throw error; return null; });
        return moment && { id: one.entity, moment };
      }));
      return all.filter((one) => one !== null);
    };
  };
  /** The value that a link leads to. */
  const follow = (signal: AbortSignal) => async (id: string): Promise<unknown> => {
    const { entity, time, instance } = parseId(id);
    if (time === undefined) return null;
    const moment = await kept.ask({ entity, at: time, which: 'exact', news: '' }, kMaxAgeMs.live, signal);
    return moment?.instances[instance ?? 0]?.data ?? null;
  };
  /** The poses of a moment, with sizes and views that it links to. */
  const placesOf = async (found: Found, signal: AbortSignal): Promise<Placed[]> => {
    const value = valueOf(found);
    const places = posesIn(value);
    const link = linkIn(value, /class|model/i);
    const size = link === undefined || places.some((placed) => placed.size) ? undefined : sizeIn(await follow(signal)(link).catch(() => null));
    const isSeeing = places.some((placed) => placed.isCamera);
    const lens = isSeeing ? (await frameOf(value, follow(signal))).lens : undefined;
    const half: readonly [number, number] = lens ? [(lens.cx + 0.5) / lens.fx, (lens.cy + 0.5) / lens.fy] : [kHalfView, kHalfView];
    return places.map((placed) => ({ ...placed, ...(size ? { size } : {}), ...(placed.isCamera ? { half } : {}) }));
  };
  /** Predictions of images take long to learn, for a pose that the robot's head has, too. What came once does not move. */
  const isQuickToPredict = (id: string): boolean => {
    const node = nodeOf(id);
    return node?.snapshots !== 1 && !(node?.kinds ?? []).some((kind) => kind === 'image' || kind === 'depth');
  };
  return { idsOf, ask, follow, placesOf, isQuickToPredict };
}
export type Sources = ReturnType<typeof createSources>;
