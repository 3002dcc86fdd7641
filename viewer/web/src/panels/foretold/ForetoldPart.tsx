// SPDX-License-Identifier: Apache-2.0
// In a memory that records, the future comes: when what was predicted at the cursor is recorded, the
// recorded moment takes its place, and this part tells how wrong the prediction was.
import { createEffect, createMemo, createSignal, For, on, Show, untrack, type Accessor } from 'solid-js';
import { getJson } from '../../api/client';
import { moment as momentDecoder, type Moment } from '../../api/types';
import { parseId } from '../../state/ids';
import { createRequest } from '../../state/request';
import { cursor, ownLast, say } from '../../state/store';
import { formatClock, formatDuration, formatNumber } from '../../time/format';
import { compare, summaryOf } from './compare';

export interface Came {
  readonly predicted: Moment;
  readonly real: Moment;
  readonly at: bigint;
}

/** What comes may lie beside the time that was asked for, but by less than half of the way there. */
function isOf(predicted: Moment, real: Moment, at: bigint): boolean {
  const from = predicted.from ?? at - (predicted.horizon ?? 0n);
  const beside = real.time > at ? real.time - at : at - real.time;
  return real.source !== 'predicted' && real.time > from && 2n * beside < at - from;
}

/** True if the next snapshot is not nearer to that time. */
const isNearest = (here: Moment, at: bigint): boolean => here.next === undefined || at - here.time <= here.next - at;

/** The first prediction of an entity at the cursor, and what came in its place. */
export function createCame(entity: Accessor<string>, moment: Accessor<Moment | undefined>): Accessor<Came | undefined> {
  const [kept, setKept] = createSignal<{ readonly entity: string; readonly at: bigint; readonly predicted: Moment } | null>(null);
  createEffect(() => {
    const [id, at, here] = [entity(), cursor(), moment()];
    const before = untrack(kept);
    const isSame = before !== null && before.entity === id && before.at === at;
    if (isSame) return;
    const isHere = here !== undefined && here.source === 'predicted' && here.time === at && parseId(here.id).entity === id;
    if (isHere || before !== null) setKept(isHere ? { entity: id, at, predicted: here } : null);
  });
  const known = () => { const one = kept(); return one && one.entity === entity() && one.at === cursor() ? one : null; };
  const isDecided = createMemo(() => { const one = known(); return one !== null && ownLast(one.entity) >= one.at; });
  const shown = () => { const here = moment(); return here && here.source !== 'predicted' && parseId(here.id).entity === entity() ? here : undefined; };
  // What came may be the snapshot just after the cursor.
  const beside = createRequest<Moment>(() => {
    const one = known();
    const here = shown();
    if (!one || !here || !isDecided() || (isOf(one.predicted, here, one.at) && isNearest(here, one.at))) return null;
    return { group: `${one.entity} ${one.at}`, run: (signal) => getJson('moment', { entity: one.entity, at: one.at, which: 'nearest' }, momentDecoder, signal) };
  });
  return createMemo(() => {
    const one = known();
    if (!one || !isDecided() || !shown()) return undefined;
    const real = (beside.isBusy() ? [] : [beside.data(), shown()]).find((found) => found !== undefined && isOf(one.predicted, found, one.at));
    return real ? { predicted: one.predicted, real, at: one.at } : undefined;
  });
}

const kFew = 8;

export function ForetoldPart(props: { came: Came }) {
  const [isAll, setAll] = createSignal(false);
  const rows = createMemo(() => compare(props.came.predicted, props.came.real));
  const shown = () => (isAll() ? rows() : rows().slice(0, kFew));
  createEffect(on(rows, (now) => say(`What was predicted has come. ${summaryOf(now)}`)));
  const beside = () => { const { at, real } = props.came; return real.time === at ? '' : `, ${formatDuration(real.time > at ? real.time - at : at - real.time)} ${real.time > at ? 'after' : 'before'} that time`; };
  return (
    <section class="foretold" aria-label="What was predicted">
      <p><b>Predicted</b> {props.came.predicted.horizon === undefined ? '' : `${formatDuration(props.came.predicted.horizon)} ahead `}{props.came.predicted.engine ? `by ${props.came.predicted.engine}` : ''}; recorded at {formatClock(props.came.real.time, 3)}{beside()}. {summaryOf(rows())}</p>
      <Show when={rows().length > 0}>
        <table>
          <thead><tr><th scope="col">number</th><th scope="col">predicted</th><th scope="col">recorded</th><th scope="col">error</th><th scope="col">bound</th></tr></thead>
          <tbody><For each={shown()}>{(row) => (
            <tr>
              <th scope="row">{row.path || 'value'}{props.came.real.instances.length > 1 ? ` (${row.instance})` : ''}</th><td>{formatNumber(row.predicted)}</td><td>{formatNumber(row.real)}</td><td>{Number(row.error.toPrecision(3))}</td>
              <td class={Number.isNaN(row.bound) ? 'muted' : row.isWithin ? 'within' : 'outside'} title={Number.isNaN(row.bound) ? undefined : `The bound was ${row.bound.toPrecision(3)}.`}>{Number.isNaN(row.bound) ? 'none' : row.isWithin ? 'within the bound' : 'outside'}</td>
            </tr>
          )}</For></tbody>
        </table>
        <Show when={rows().length > shown().length}><button class="chip" onClick={() => setAll(true)}>and {rows().length - shown().length} more</button></Show>
      </Show>
    </section>
  );
}
