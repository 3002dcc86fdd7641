// SPDX-License-Identifier: Apache-2.0
// Predicted values of the series of a plot, coarse steps first.
import { getJson } from '../../api/client';
import { moments, type Moment } from '../../api/types';
import { boundOf } from '../foretold/compare';
import { numberAt } from '../values';

export interface Foreseen {
  readonly from: bigint;
  readonly engine: string;
  /** One for each path, of the same length as `times`. */
  readonly values: readonly (readonly number[])[];
  readonly bounds: readonly (readonly number[])[];
  readonly times: readonly bigint[];
}

/** Horizons up to `reach`, in `count` even steps. */
export const horizonsUpTo = (reach: bigint, count: number): bigint[] =>
  Array.from({ length: count }, (_, i) => (reach * BigInt(i + 1)) / BigInt(count)).filter((horizon) => horizon > 0n);

function foreseen(answers: readonly Moment[], paths: readonly string[], from: bigint): Foreseen {
  return {
    from: answers[0]?.from ?? from,
    engine: answers[0]?.engine ?? '',
    times: answers.map((moment) => moment.time),
    values: paths.map((path) => answers.map((moment) => numberAt(moment.instances[0]?.data, path))),
    bounds: paths.map((path) => answers.map((moment) => boundOf(moment, path))),
  };
}

/** Asks twice: three steps at once, then many. `show` gets the first answer. */
export async function foresee(entity: string, paths: readonly string[], at: bigint | undefined, reach: bigint, show: (coarse: Foreseen) => void, signal: AbortSignal): Promise<Foreseen> {
  const ask = async (count: number) => {
    const horizon = horizonsUpTo(reach, count).join(',');
    return foreseen(await getJson('predict', { entity, at, horizon }, moments, signal), paths, at ?? 0n);
  };
  show(await ask(3));
  return ask(16);
}
