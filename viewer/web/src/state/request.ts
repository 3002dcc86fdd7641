// SPDX-License-Identifier: Apache-2.0
import { createEffect, createSignal, onCleanup, type Accessor } from 'solid-js';
import { Latest } from '../api/latest';

export interface Ask<T> {
  /** What is asked about. The answer of another group is thrown away. */
  readonly group: string;
  readonly run: (signal: AbortSignal) => Promise<T>;
}

export interface Request<T> {
  readonly data: Accessor<T | undefined>;
  /** A text for a person, or an empty one. */
  readonly error: Accessor<string>;
  readonly isBusy: Accessor<boolean>;
  readonly retry: () => void;
}

export const messageOf = (error: unknown): string => (error instanceof Error ? error.message : String(error));

/** Asks whenever `source` changes: one request at a time, the latest wins. Null asks nothing. */
export function createRequest<T>(source: () => Ask<T> | null): Request<T> {
  const [data, setData] = createSignal<T>();
  const [error, setError] = createSignal('');
  const [isBusy, setBusy] = createSignal(false);
  const [attempt, setAttempt] = createSignal(0);
  let group = '';
  const latest = new Latest<T>(
    (result) => { setError(''); setData(() => result); },
    (failure) => { setData(undefined); setError(messageOf(failure)); },
    setBusy,
  );
  createEffect(() => {
    attempt();
    const ask = source();
    if (ask === null || ask.group !== group) {
      setData(undefined);
      setError('');
    }
    group = ask?.group ?? '';
    if (ask === null) latest.cancel();
    else latest.run(ask.group, ask.run);
  });
  onCleanup(() => latest.close());
  return { data, error, isBusy, retry: () => setAttempt((n) => n + 1) };
}
