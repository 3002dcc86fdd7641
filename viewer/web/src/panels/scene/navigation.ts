// SPDX-License-Identifier: Apache-2.0
// What navigation knew at the cursor: the newest cost map, the plans that hold, and named places.
import { createEffect, createMemo, onCleanup, type Accessor } from 'solid-js';
import type { Object3D } from 'three';
import { getJson } from '../../api/client';
import { queryAnswer } from '../../skills/executions';
import { parseId, queryNames, shortName } from '../../state/ids';
import { isMoving } from '../../state/moving';
import { createRequest } from '../../state/request';
import { cursor } from '../../state/store';
import { formatClock, formatNumber, formatTime } from '../../time/format';
import { theme } from '../../ui/theme';
import { costMapIn, type CostMap } from './costMap';
import { mapObject, planObject } from './floor';
import { composed, driveEventIn, endOf, headingOf, isPathMissing, placeIn, planIn, type DriveEvent, type Plan, type Planar } from './plans';
import { posesIn, isInWorld } from './poses';
import { valueOf, type Found, type Sources } from './sources';

const kMaxKept = 6;
const atOrBefore = (): string => 'at-or-before';

export interface ShownMap { readonly id: string; readonly map: CostMap | string }
export interface ShownPlace { readonly id: string; readonly name: string; readonly pose: Planar }

/** All of a value: moments tell summaries of long arrays alone. */
function createWhole(): (id: string, signal: AbortSignal) => Promise<unknown> {
  const kept = new Map<string, Promise<unknown>>();
  return (id, signal) => {
    const known = kept.get(id);
    if (known) return known;
    const { entity, time } = parseId(id);
    const asked = getJson('query', { q: `${queryNames(entity)} @ ${formatTime(time ?? 0n)}` }, queryAnswer, signal).then((answer) => answer.entities[0]?.snapshots[0]?.instances[0]?.data);
    kept.set(id, asked);
    asked.catch(() => kept.delete(id));
    if (kept.size > kMaxKept) kept.delete(kept.keys().next().value!);
    return asked;
  };
}

export interface Shown { readonly map: Accessor<boolean>; readonly plans: Accessor<boolean>; readonly places: Accessor<boolean> }
type Show = (kind: 'map' | 'plan', objects: readonly Object3D[]) => void;

export function createNavigation(sources: Sources, shown: Shown, show: Show) {
  const whole = createWhole();
  const idsOf = (role: 'floor' | 'plan' | 'drive' | 'location') => createMemo(() => sources.idsOf(role), [], { equals: (a, b) => a.join() === b.join() });
  const [mapIds, planIds, driveIds, placeIds] = [idsOf('floor'), idsOf('plan'), idsOf('drive'), idsOf('location')];
  const found = (ids: Accessor<string[]>, isOn: Accessor<boolean>, group: string) => createRequest<Found[]>(() => (isOn() && ids().length > 0 ? { group, run: sources.ask(ids(), cursor(), atOrBefore) } : null));
  const maps = found(mapIds, shown.map, 'maps');
  const plans = found(planIds, shown.plans, 'plans');
  const drives = found(driveIds, shown.plans, 'drives');
  const places = found(placeIds, shown.places, 'places');

  const newest = createMemo(() => (maps.data() ?? []).reduce<Found | null>((best, one) => (best === null || one.moment.time > best.moment.time ? one : best), null)?.moment.id ?? '', '');
  let last: ShownMap | undefined;
  const map = createRequest<ShownMap>(() => {
    const id = newest();
    // A map is as large as a picture: while the cursor moves, the last one stays.
    if (id === '' || (isMoving() && last?.id !== id)) return id === '' || !last ? null : { group: 'map', run: async () => last! };
    return { group: 'map', run: async (signal) => (last = last?.id === id ? last : { id, map: costMapIn(await whole(id, signal)) }) };
  });
  createEffect(() => {
    const told = shown.map() ? map.data()?.map : undefined;
    show('map', told && typeof told !== 'string' ? [mapObject(told)] : []);
  });

  const ended = createMemo(() => new Map((drives.data() ?? []).map((one) => [parseId(one.id).entity.split('/')[2] ?? '', driveEventIn(one.moment.id, valueOf(one))])));
  const shownPlans = createRequest<{ plan: Plan; end: DriveEvent | undefined }[]>(() => {
    const [all, ends] = [plans.data(), ended()];
    if (!all) return null;
    return {
      group: 'plans',
      run: async (signal) => (await Promise.all(all.map(async (one) => {
        const value = valueOf(one);
        const plan = planIn(one.moment.id, isPathMissing(value) ? await whole(one.moment.id, signal) : value);
        return plan && { plan, end: endOf(plan, ends.get(one.id.split('/')[2] ?? '')) };
      }))).filter((one) => one !== undefined),
    };
  });
  createEffect(() => {
    const { accent, hover } = theme();
    const all = shown.plans() ? shownPlans.data() ?? [] : [];
    show('plan', all.filter(({ plan, end }) => end === undefined && plan.path.length > 1).map(({ plan }) => planObject(plan.path, plan.isRefused ? hover : accent, plan.isRefused)));
  });
  onCleanup(() => { show('map', []); show('plan', []); });

  const named = createMemo(() => (places.data() ?? []).flatMap((one) => { const place = placeIn(valueOf(one)); return place ? [{ id: one.id, place }] : []; }));
  const objects = createRequest<Found[]>(() => {
    const ids = [...new Set(named().filter(({ place }) => !place.pose).map(({ place }) => place.object))];
    return ids.length === 0 ? null : { group: 'objects', run: sources.ask(ids, cursor(), atOrBefore) };
  });
  /** Places where they are now: those beside an object move with it. */
  const flags = createMemo<ShownPlace[]>(() => (shown.places() ? named() : []).flatMap(({ id, place }) => {
    const name = place.name || shortName(id);
    if (place.pose) return [{ id, name, pose: place.pose }];
    const object = objects.data()?.find((one) => one.id === place.object);
    const at = object && posesIn(valueOf(object)).find(isInWorld);
    return at && place.poseInObject ? [{ id, name, pose: composed([at.position[0], at.position[1], headingOf(at.orientation)], place.poseInObject) }] : [];
  }));

  const noteOfMap = (): string[] => {
    const told = map.data();
    if (!shown.map() || !told) return [];
    const name = parseId(told.id).entity.split('/').slice(2).join('/');
    if (typeof told.map === 'string') return [`The cost map ${name} is not drawn: ${told.map}.`];
    const { rows, columns, resolution, leftOut } = told.map;
    const size = (cells: number) => formatNumber(Math.round(cells * resolution * 100) / 100);
    return [`Cost map ${name} of ${formatClock(parseId(told.id).time!)}: ${size(columns)} x ${size(rows)} m.`, ...leftOut.slice(0, 3).map((reason) => `The map left something out: ${reason}.`)];
  };
  const noteOf = ({ plan, end }: { plan: Plan; end: DriveEvent | undefined }): string => {
    const goal = plan.goal === '' ? 'its goal' : `'${plan.goal}'`;
    if (plan.isRefused) return `No way to ${goal} since ${formatClock(plan.time)}: ${plan.reason}.`;
    if (end) return `The drive to ${goal} ${end.kind} at ${formatClock(end.time)}: ${end.reason}.`;
    return `Plan to ${goal} of ${formatClock(plan.time)}${plan.length > 0 ? `, ${plan.length.toFixed(2)} m` : ''}.`;
  };
  const notes = createMemo<string[]>(() => [
    ...noteOfMap(), ...(shown.plans() ? shownPlans.data() ?? [] : []).map(noteOf),
    ...[['The cost map', map.error() || maps.error()], ['The plan', shownPlans.error() || plans.error() || drives.error()], ['Places', places.error() || objects.error()]].filter(([, error]) => error !== '').map(([what, error]) => `${what} cannot be told. ${error}`),
  ]);
  return {
    flags, notes, hasMaps: () => mapIds().length > 0, hasPlans: () => planIds().length > 0, hasPlaces: () => placeIds().length > 0,
    isThere: () => mapIds().length + planIds().length + placeIds().length > 0, isBusy: () => map.isBusy() || shownPlans.isBusy(),
  };
}
