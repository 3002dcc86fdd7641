// SPDX-License-Identifier: Apache-2.0
import { createMemo, For, Show } from 'solid-js';
import type { ForgetPlan, PlannedEntity } from '../../api/nightTypes';
import { cursor, selected, setCursor, setSelected } from '../../state/store';
import { formatBytes, formatClock, formatCount, formatDate } from '../../time/format';
import { timeAt, xOf } from '../../time/span';
import { kLaneHeight, lanePaths, sumOf, type Lane } from './lanes';

const fadingOf = (entity: PlannedEntity): number => entity.fading.reduce((sum, part) => sum + part.snapshots, 0);
const counted = (count: number): string => (count === 0 ? '' : formatCount(count));
const about = (bytes: number): string => (bytes === 0 ? '' : formatBytes(bytes));

/** Why something goes or fades, a reason a line. */
const reasonsOf = (entity: PlannedEntity): string =>
  [...Object.entries(entity.reasons).map(([reason, count]) => `${formatCount(count)} go: ${reason}`), ...Object.entries(entity.fading_reasons).map(([reason, count]) => `${formatCount(count)} fade ${reason}`),
    ...(entity.protected > 0 ? [`${formatCount(entity.protected)} are protected`] : []), ...(entity.not_sealed_yet > 0 ? [`${formatCount(entity.not_sealed_yet)} are not sealed yet`] : [])].join('; ');

/** The same over all entities: each reason once, the commonest first. */
function allReasons(entities: readonly PlannedEntity[]): string[] {
  const sums = new Map<string, number>();
  for (const entity of entities)
    for (const [what, reasons] of [['go', entity.reasons], ['fade', entity.fading_reasons]] as const)
      for (const [reason, count] of Object.entries(reasons)) { const key = what === 'go' ? `go: ${reason}` : `fade ${reason}`; sums.set(key, (sums.get(key) ?? 0) + count); }
  return [...sums].sort((a, b) => b[1] - a[1]).map(([reason, count]) => `${formatCount(count)} ${reason}`);
}

/** A plan as a picture: a lane for each entity, and beside it the same in numbers. */
export function ForgetPicture(props: { found: ForgetPlan }) {
  const plan = () => props.found.plan;
  const lanes = createMemo(() => props.found.entities.flatMap((entity) => (entity.lane ? [entity.lane] : [])));
  const all = createMemo(() => sumOf(lanes(), props.found.bins));
  const stays = createMemo(() => props.found.entities.reduce((sum, entity) => sum + entity.stays, props.found.left_out_stays));
  const reasons = createMemo(() => allReasons(props.found.entities));
  const isLong = () => props.found.to - props.found.from > 86_400_000_000_000n;
  const endText = (time: bigint) => (isLong() ? formatDate(time) : formatClock(time, 0));
  return (
    <>
      <p class="sums" role="status">
        <b class="goes">{formatCount(plan().snapshots)}</b> of {formatCount(plan().snapshots + stays())} snapshots would go, about {formatBytes(plan().freed_bytes)};
        {' '}<b class="fades">{formatCount(plan().fading)}</b> would fade, about {formatBytes(plan().faded_bytes)}.
        {' '}The store has {formatBytes(plan().store_bytes)}, then about <b>{formatBytes(Math.max(0, plan().store_bytes - plan().freed_bytes - plan().faded_bytes))}</b>.
      </p>
      <ul class="plan-why" aria-label="Why">
        <For each={reasons()}>{(reason) => <li>{reason}</li>}</For>
        <li class="plan-legend" aria-hidden="true"><i class="gone" />goes <i class="fades" />fades <i class="stays" />stays</li>
      </ul>
      <Show when={plan().fades_for_quota}><p class="bar muted">What fading for the quota frees shows only afterwards; then more may go.</p></Show>
      <Show when={plan().quota_missing_bytes > 0 && !plan().fades_for_quota}><p class="bar night-failure">The quota would not be met: about {formatBytes(plan().quota_missing_bytes)} more would have to go, which is protected, not sealed yet, or no data.</p></Show>
      <Show when={plan().notes.length > 0}><details class="plan-notes"><summary>{formatCount(plan().notes.length)} note{plan().notes.length === 1 ? '' : 's'} on what is left of it</summary><ul><For each={plan().notes}>{(note) => <li>{note}</li>}</For></ul></details></Show>
      <div class="plan" tabindex="0" role="region" aria-label="What would stay, fade and go">
        <table>
          <thead><tr>
            <th scope="col">entity</th>
            <th scope="col"><span class="lane-ends"><span>{endText(props.found.from)}</span><span>{endText(props.found.to)}</span></span></th>
            <th scope="col">goes</th><th scope="col">fades</th><th scope="col" title="Those that fade stay, too">stays</th><th scope="col">frees</th>
          </tr></thead>
          <tbody>
            <tr class="plan-all"><th scope="row">all</th><td class="lane-cell"><LaneOf lane={all()} found={props.found} /></td><td>{counted(plan().snapshots)}</td><td>{counted(plan().fading)}</td><td>{formatCount(stays())}</td><td>{about(plan().freed_bytes + plan().faded_bytes)}</td></tr>
            <For each={props.found.entities}>{(entity) => (
              <tr classList={{ whole: entity.forgotten === 0 && entity.fading.length === 0 }} title={reasonsOf(entity)}>
                <th scope="row"><button classList={{ chosen: selected() === entity.id }} title={`Choose ${entity.id}`} onClick={() => setSelected(entity.id)}>{entity.id}</button></th>
                <td class="lane-cell"><Show when={entity.lane}><LaneOf lane={entity.lane!} found={props.found} entity={entity.id} /></Show></td>
                <td>{counted(entity.forgotten)}</td><td>{counted(fadingOf(entity))}</td><td>{formatCount(entity.stays)}</td><td>{about(entity.freed_bytes + entity.faded_bytes)}</td>
              </tr>
            )}</For>
          </tbody>
        </table>
        <Show when={props.found.left_out > 0}><p class="bar muted">{formatCount(props.found.left_out)} more entities lose nothing and are left out.</p></Show>
      </div>
    </>
  );
}

/** A click goes to a moment; the table has the numbers, so the picture itself is for eyes alone. */
function LaneOf(props: { lane: Lane; found: ForgetPlan; entity?: string }) {
  const paths = createMemo(() => lanePaths(props.lane));
  const span = () => ({ from: props.found.from, to: props.found.to });
  const here = () => xOf(cursor(), span(), props.found.bins);
  const go = (event: MouseEvent) => {
    const box = (event.currentTarget as SVGSVGElement).getBoundingClientRect();
    if (props.entity !== undefined) setSelected(props.entity);
    setCursor(timeAt(event.clientX - box.left, span(), box.width));
  };
  return (
    <svg class="plan-lane" aria-hidden="true" viewBox={`0 0 ${props.found.bins} ${kLaneHeight}`} preserveAspectRatio="none" onClick={go}>
      <path class="gone" d={paths().gone} /><path class="fades" d={paths().fades} /><path class="stays" d={paths().stays} />
      <Show when={here() >= 0 && here() <= props.found.bins}><path class="here" d={`M${here()} 0V${kLaneHeight}`} /></Show>
    </svg>
  );
}
