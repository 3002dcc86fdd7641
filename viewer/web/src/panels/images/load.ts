// SPDX-License-Identifier: Apache-2.0
// Which pictures belong to a moment, and their loading: all of one moment together, so that what is
// side by side is of one time.
import { ApiError, getImage, getJson, type Picture } from '../../api/client';
import { moment as momentDecoder, type Moment } from '../../api/types';
import { messageOf } from '../../state/request';

export interface Tile {
  readonly title: string;
  readonly picture?: Picture;
  /** Why there is none. */
  readonly missing?: string;
  readonly time?: bigint;
}

interface Wanted {
  readonly title: string;
  readonly time: bigint;
  readonly form: string;
  readonly as: string;
  readonly extra?: Record<string, string | bigint>;
}

export interface Asked {
  readonly entity: string;
  readonly path: string;
  readonly instance: number;
  readonly isMoving: boolean;
}

/** What it means that a form is not there, and what brings it. */
const kAbsent: Record<string, string> = {
  recorded: 'The recorded image was dropped after a night kept it as latents.',
  latent: 'No latents yet. A night makes them: engram consolidate.',
  error: 'The error shows where both forms are kept.',
};

async function one(asked: Asked, wanted: Wanted, signal: AbortSignal, forms?: readonly string[]): Promise<Tile> {
  const needed = wanted.form === 'error' ? ['recorded', 'latent'] : wanted.form === 'any' || wanted.form === 'predicted' ? [] : [wanted.form];
  // What the gateway said is not there is not asked for.
  if (forms && needed.some((form) => !forms.includes(form))) return { title: wanted.title, time: wanted.time, missing: kAbsent[wanted.form] };
  const params = { id: `${asked.entity}/${wanted.time}/${asked.instance}`, path: asked.path, form: wanted.form, as: wanted.as, quality: wanted.as === 'jpeg' ? 92 : undefined, ...wanted.extra };
  try {
    return { title: wanted.title, time: wanted.time, picture: await getImage(params, signal) };
  } catch (error) {
    if (signal.aborted) throw error;
    const isAbsent = error instanceof ApiError && error.code === 'not found';
    return { title: wanted.title, time: wanted.time, missing: (isAbsent ? kAbsent[wanted.form] : undefined) ?? messageOf(error) };
  }
}

const still = (asked: Asked): string => (asked.isMoving ? 'jpeg' : 'png');

/** Recorded, reconstructed and where they differ; or what is predicted beside the last that was seen. */
export async function loadTiles(asked: Asked, here: Moment, signal: AbortSignal): Promise<Tile[]> {
  const wanted: Wanted[] =
    here.source === 'predicted'
      ? [
          ...(here.from !== undefined ? [{ title: 'Last seen', time: here.from, form: 'any', as: still(asked) }] : []),
          { title: 'Predicted', time: here.time, form: 'predicted', as: still(asked), extra: { ...(here.from !== undefined ? { from: here.from } : {}), ...(here.horizon !== undefined ? { horizon: here.horizon } : {}) } },
        ]
      : [
          { title: 'Recorded', time: here.time, form: 'recorded', as: still(asked) },
          { title: 'Reconstructed', time: here.time, form: 'latent', as: still(asked) },
          { title: 'Error map', time: here.time, form: 'error', as: 'png' },
        ];
  return Promise.all(wanted.map((want) => one(asked, want, signal, here.forms)));
}

/** The nearest snapshot may be far away, such as the last one for a time after it. */
const isNear = (found: bigint, wanted: bigint, horizon: bigint): boolean => 2n * (found > wanted ? found - wanted : wanted - found) < horizon;

/** What is predicted from a past moment, beside what really came. */
export async function loadForesight(asked: Asked, here: Moment, horizon: bigint, signal: AbortSignal): Promise<Tile[]> {
  const came = getJson('moment', { entity: asked.entity, at: here.time + horizon, which: 'nearest' }, momentDecoder, signal);
  const [now, predicted, later] = await Promise.all([
    one(asked, { title: 'From here', time: here.time, form: 'any', as: still(asked) }, signal),
    one(asked, { title: 'Predicted', time: here.time + horizon, form: 'predicted', as: still(asked), extra: { from: here.time, horizon } }, signal),
    came.then((then): Promise<Tile> | Tile => isNear(then.time, here.time + horizon, horizon) ? one(asked, { title: 'What came', time: then.time, form: 'any', as: still(asked) }, signal) : { title: 'What came', missing: 'Nothing was recorded at that time.' }, (error: unknown) => ({ title: 'What came', missing: messageOf(error) })),
  ]);
  return [now, predicted, later];
}
