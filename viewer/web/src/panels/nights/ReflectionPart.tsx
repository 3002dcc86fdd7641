// SPDX-License-Identifier: Apache-2.0
import { createMemo, createSignal, For, Show } from 'solid-js';
import { ApiError, getJson } from '../../api/client';
import { calledOff, reflection, type Reflection } from '../../api/nightTypes';
import { createRequest } from '../../state/request';
import { info } from '../../state/store';
import { formatCount, formatDuration, formatTime } from '../../time/format';
import { Empty } from '../../ui/PanelFrame';
import { Findings } from './Findings';
import { findingsText } from './told';
import { newPageName } from './policy';

type Answer = Reflection | { readonly reason: string };

/** That nothing was recorded is an answer, and no failure. */
export const askReflection = (params: Record<string, string | number | bigint>, signal: AbortSignal): Promise<Answer> =>
  getJson('reflection', params, reflection, signal).catch((error: unknown) => {
    if (error instanceof ApiError && error.code === 'not found') return { reason: error.message };
    throw error;
  });

/** What the memory tells about itself: as a reflection was recorded, or as it is now. */
export function ReflectionPart() {
  const page = newPageName();
  /** A recorded reflection by its time, 'latest', or 'now'; counted, so that one can look again. */
  const [choice, setChoice] = createSignal<{ readonly which: string; readonly attempt: number }>({ which: 'latest', attempt: 0 });
  const [times, setTimes] = createSignal<readonly bigint[]>([]);
  const asked = createRequest<Answer>(() => {
    const { which, attempt } = choice();
    if (which === '' || !info()) return null;
    return { group: `${which} ${attempt}`, run: async (signal) => {
      const found = await askReflection(which === 'now' ? { look: 1, page } : which === 'latest' ? {} : { at: which }, signal);
      if ('times' in found && found.times.length > 0) setTimes(found.times);
      return found;
    } };
  });
  const found = createMemo(() => { const answer = asked.data(); return answer && 'findings' in answer ? answer : undefined; });
  const reason = () => { const answer = asked.data(); return answer && 'reason' in answer ? answer.reason : ''; };
  const isStore = () => info()?.stores[0]?.path !== undefined;
  const isLooking = () => asked.isBusy() && choice().which === 'now';
  const look = () => setChoice({ which: 'now', attempt: choice().attempt + 1 });
  const stop = () => {
    setChoice({ which: '', attempt: choice().attempt });
    void getJson('reflection', { page, stop: 1 }, calledOff).catch(() => undefined);
  };
  const rates = createMemo(() => (found()?.rates ?? []).filter((rate) => rate.by === 'all' || rate.name !== '-'));
  return (
    <>
      <div class="bar">
        <Show when={times().length > 0}>
          <label class="field">Recorded <select value={found()?.is_recorded ? String(found()!.time) : ''} onChange={(event) => setChoice({ which: event.currentTarget.value, attempt: 0 })}>
            <Show when={!found()?.is_recorded}><option value="">choose one</option></Show>
            <For each={[...times()].reverse()}>{(time) => <option value={String(time)}>{formatTime(time)}</option>}</For>
          </select></label>
        </Show>
        <Show when={isStore()}><Show when={isLooking()} fallback={<button onClick={look} title="Looks at all that is stored now, and records nothing">Look now</button>}><button onClick={stop}>Stop</button></Show></Show>
        <Show when={asked.isBusy()}><span class="muted" role="status">{isLooking() ? 'looking at all snapshots ...' : 'loading ...'}</span></Show>
        <Show when={found()}><span><b>{findingsText(found()!)}</b> <span class="muted">{found()!.is_recorded ? `in the reflection of ${formatTime(found()!.time)}` : `by a look at ${formatTime(found()!.time)}, which is not recorded`}</span></span></Show>
      </div>
      <Show when={asked.error()}><div class="failure" role="alert"><p>{asked.error()}</p><button onClick={asked.retry}>Try again</button></div></Show>
      <Show when={reason() !== ''}><Empty title="No reflection yet">{reason()}</Empty></Show>
      <Show when={found()}>
        <div class="reflection-body" tabindex="0" role="region" aria-label="Reflection">
          <Findings findings={found()!.findings} />
          <Show when={rates().length > 0}>
            <table class="rates">
              <caption>How often skills succeed, with an interval of 95 %</caption>
              <thead><tr><th scope="col">skill</th><th scope="col">success</th><th scope="col">runs</th><th scope="col">interval</th><th scope="col">stopped</th><th scope="col">takes</th></tr></thead>
              <tbody><For each={rates()}>{(rate) => (
                <tr classList={{ part: rate.by !== 'all' }}><th scope="row">{rate.by === 'all' ? rate.skill : `${rate.by} ${rate.name}`}</th><td>{rate.runs === 0 ? '' : `${Math.round((100 * rate.successes) / rate.runs)} %`}</td><td>{formatCount(rate.runs)}</td><td>{Math.round(100 * rate.low)} to {Math.round(100 * rate.high)} %</td><td>{rate.stops === 0 ? '' : formatCount(rate.stops)}</td><td>{rate.runs === 0 ? '' : formatDuration(Math.round(rate.duration_s * 1e9))}</td></tr>
              )}</For></tbody>
            </table>
          </Show>
          <Show when={found()!.chains.length > 0}>
            <h3>What follows a failure or a stop</h3>
            <ol class="chains"><For each={found()!.chains}>{(chain) => <li><b>{formatCount(chain.count)} ×</b> {chain.steps.join(' → ')}</li>}</For></ol>
          </Show>
        </div>
      </Show>
    </>
  );
}
