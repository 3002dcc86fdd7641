// SPDX-License-Identifier: Apache-2.0
// The snapshot of an entity below the cursor, recorded, reconstructed or predicted.
import { createMemo } from 'solid-js';
import { ApiError, getJson } from '../api/client';
import { members, moment, type Member, type Moment } from '../api/types';
import { formatTime } from '../time/format';
import { namedMembers } from './joints';
import { cursor, info, last, nodeOf, ownLast } from './store';
import { createRequest, type Request } from './request';

/** True if the cursor lies where this entity can only be predicted. */
export function isPredicted(entity: string, at: bigint): boolean {
  const known = info();
  return known !== undefined && at > last() && at - ownLast(entity) <= known.max_horizon_ns;
}

export function createMoment(entity: () => string, at: () => bigint = cursor): Request<Moment> {
  const isAhead = createMemo(() => isPredicted(entity(), at()));
  // A commit before the cursor changes what is below it, and a prediction from it; those behind do not.
  const newest = createMemo(() => { const own = ownLast(entity()); return own < at() ? own : at(); });
  return createRequest(() => {
    const id = entity();
    newest();
    if (id === '' || info() === undefined) return null;
    const time = at();
    const first = nodeOf(id)?.first;
    if (first !== undefined && time < first)
      return { group: `${id} before`, run: () => Promise.reject(new ApiError('not found', `Nothing is known yet at this time: the first snapshot is at ${formatTime(first)}.`)) };
    const which = isAhead() ? 'predict' : 'at-or-before';
    return { group: `${id} ${which}`, run: (signal) => getJson('moment', { entity: id, at: time, which }, moment, signal) };
  });
}

const known = new Map<string, Promise<Member[]>>();

/** The members of an entity, asked for once. */
export function membersOf(entity: string): Promise<Member[]> {
  let promise = known.get(entity);
  if (!promise) {
    promise = getJson('members', { entity }, members).then((answer) => namedMembers(entity, answer.members));
    promise.catch(() => known.delete(entity));
    known.set(entity, promise);
  }
  return promise;
}

export const createMembers = (entity: () => string): Request<Member[]> =>
  createRequest(() => (entity() === '' ? null : { group: entity(), run: () => membersOf(entity()) }));
