// SPDX-License-Identifier: Apache-2.0
// The snapshot of an entity below the cursor, recorded, reconstructed or predicted.
import { ApiError, getJson } from '../api/client';
import { members, moment, type Member, type Moment } from '../api/types';
import { formatTime } from '../time/format';
import { cursor, info, last, nodeOf } from './store';
import { createRequest, type Request } from './request';

/** True if the cursor lies where this entity can only be predicted. */
export function isPredicted(entity: string, at: bigint): boolean {
  const known = info();
  const own = nodeOf(entity)?.last ?? last();
  return known !== undefined && at > last() && at - own <= known.max_horizon_ns;
}

export const createMoment = (entity: () => string, at: () => bigint = cursor): Request<Moment> =>
  createRequest(() => {
    const id = entity();
    if (id === '' || info() === undefined) return null;
    const time = at();
    const first = nodeOf(id)?.first;
    if (first !== undefined && time < first)
      return { group: `${id} before`, run: () => Promise.reject(new ApiError('not found', `Nothing is known yet at this time: the first snapshot is at ${formatTime(first)}.`)) };
    const which = isPredicted(id, time) ? 'predict' : 'at-or-before';
    return { group: `${id} ${which}`, run: (signal) => getJson('moment', { entity: id, at: time, which }, moment, signal) };
  });

const known = new Map<string, Promise<Member[]>>();

/** The members of an entity, asked for once. */
export function membersOf(entity: string): Promise<Member[]> {
  let promise = known.get(entity);
  if (!promise) {
    promise = getJson('members', { entity }, members).then((answer) => answer.members);
    promise.catch(() => known.delete(entity));
    known.set(entity, promise);
  }
  return promise;
}

export const createMembers = (entity: () => string): Request<Member[]> =>
  createRequest(() => (entity() === '' ? null : { group: entity(), run: () => membersOf(entity()) }));
