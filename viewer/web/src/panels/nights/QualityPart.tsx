// SPDX-License-Identifier: Apache-2.0
import { createMemo, createSignal, For, Show } from 'solid-js';
import { ApiError, getJson } from '../../api/client';
import { quality, type Quality } from '../../api/types';
import { follow } from '../../state/actions';
import { parseId } from '../../state/ids';
import { createRequest } from '../../state/request';
import { formatClock, formatCount } from '../../time/format';
import { createSize } from '../../ui/size';
import { barsOf, nextBar, type Bar } from './bars';

/** Snapshots that are compared; each of them is decoded for it. */
const kSample = 200;
const kHeight = 86;
const kFoot = 15;

/** How well the latents of an entity show what was recorded: a distribution, and the snapshots at its bad end. */
export function QualityPart(props: { entity: string }) {
  const asked = createRequest<Quality | { readonly reason: string }>(() => ({
    group: props.entity,
    run: (signal) => getJson('quality', { entity: props.entity, sample: kSample }, quality, signal).catch((error: unknown) => {
      // That there is nothing to compare is an answer.
      if (error instanceof ApiError && (error.code === 'not found' || error.code === 'failed precondition')) return { reason: error.message };
      throw error;
    }),
  }));
  const found = () => { const answer = asked.data(); return answer && 'counts' in answer ? answer : undefined; };
  /** For which the gateway had no time. */
  const left = () => { const one = found(); return one?.asked === undefined ? 0 : one.asked - one.compared - one.unknown; };
  const reason = () => { const answer = asked.data(); return answer && 'reason' in answer ? answer.reason : found()?.compared === 0 ? nothingOf(found()!) : ''; };
  return (
    <section class="quality" aria-label={`Quality of ${props.entity}`}>
      <h3>Quality <span class="muted">{props.entity}</span></h3>
      <Show when={asked.error()}><div class="failure" role="alert"><p>{asked.error()}</p><button onClick={asked.retry}>Try again</button></div></Show>
      <Show when={asked.data()} fallback={<Show when={!asked.error()}><div class="skeleton quality-wait" /></Show>}>
        <Show when={reason() === ''} fallback={<p class="muted">{reason()}</p>}>
          <Distribution found={found()!} />
          <p class="muted">{formatCount(found()!.compared)}{left() > 0 ? ` of ${formatCount(found()!.asked!)}` : ''} snapshots compared in both forms{found()!.unknown > 0 ? `, ${formatCount(found()!.unknown)} could not be` : ''}. A bar leads to its worst snapshot.</p>
          <ol class="worst" aria-label="Worst snapshots">
            <For each={[...found()!.worst].sort((a, b) => a.psnr - b.psnr)}>{(one) => (
              <li><button class="chip" title={one.id} onClick={() => follow(one.id)}><b>{one.psnr.toFixed(1)} dB</b> {clockOf(one.id)}</button></li>
            )}</For>
          </ol>
        </Show>
      </Show>
    </section>
  );
}

const nothingOf = (found: Quality): string =>
  found.unknown > 0 ? `${formatCount(found.unknown)} snapshots are kept in both forms, but none of them could be compared: quality is told of images.` : 'No snapshot is kept in both forms, so there is nothing to compare.';

const clockOf = (id: string): string => { const { time } = parseId(id); return time === undefined ? id : formatClock(time, 3); };

function Distribution(props: { found: Quality }) {
  const [size, sizeRef] = createSize();
  const bars = createMemo(() => barsOf(props.found));
  const [chosen, setChosen] = createSignal(-1);
  const current = () => ((bars()[chosen()]?.count ?? 0) > 0 ? chosen() : bars().findIndex((bar) => bar.count > 0));
  const highest = createMemo(() => Math.max(1, ...props.found.counts));
  const pitch = () => size().width / Math.max(1, bars().length);
  const heightOf = (bar: Bar) => (bar.count === 0 ? 0 : Math.max(2, (bar.count / highest()) * (kHeight - 4)));
  let host!: SVGSVGElement;
  const go = (bar: Bar) => { if (bar.goal) follow(bar.goal.id); };
  const onKey = (event: KeyboardEvent, i: number) => {
    if (event.altKey || event.ctrlKey || event.metaKey) return;
    if (event.key === 'ArrowRight' || event.key === 'ArrowLeft') {
      const next = nextBar(bars(), i, event.key === 'ArrowRight' ? 1 : -1);
      setChosen(next);
      host.querySelector<SVGGElement>(`[data-bar="${next}"]`)?.focus();
    } else if (event.key === 'Enter' || event.key === ' ') go(bars()[i]!);
    else return;
    event.preventDefault();
    event.stopPropagation();
  };
  const label = (bar: Bar) => `${bar.low.toFixed(1)} to ${bar.high.toFixed(1)} dB: ${bar.count} snapshot${bar.count === 1 ? '' : 's'}; go to the worst ${bar.isOwn ? 'of them' : 'of all'}`;
  const ends = () => [{ text: `${props.found.low.toFixed(1)}`, x: 0, anchor: 'start' }, { text: 'PSNR in dB', x: size().width / 2, anchor: 'middle' }, { text: (bars().at(-1)?.high ?? 0).toFixed(1), x: size().width, anchor: 'end' }] as const;
  return (
    <div class="distribution" ref={sizeRef}>
      <svg ref={host} role="group" aria-label={`Distribution of PSNR over ${props.found.compared} snapshots`} width={size().width} height={kHeight + kFoot}>
        <For each={bars()}>{(bar, i) => (
          <Show when={bar.count > 0}>
            <g class="quality-bar" classList={{ own: bar.isOwn }} role="button" data-bar={i()} tabindex={i() === current() ? 0 : -1} aria-label={label(bar)} onClick={() => go(bar)} onFocus={() => setChosen(i())} onKeyDown={(event) => onKey(event, i())}>
              <title>{label(bar)}</title>
              <rect class="reach" x={i() * pitch()} y={0} width={pitch()} height={kHeight} />
              <rect class="bar-shape" x={i() * pitch() + 0.5} y={kHeight - heightOf(bar)} width={Math.max(1, pitch() - 1)} height={heightOf(bar)} />
            </g>
          </Show>
        )}</For>
        <path class="quality-foot" d={`M0 ${kHeight + 0.5}H${size().width}`} />
        <For each={ends()}>{(end) => <text class="quality-text" x={end.x} y={kHeight + 12} text-anchor={end.anchor}>{end.text}</text>}</For>
      </svg>
    </div>
  );
}
