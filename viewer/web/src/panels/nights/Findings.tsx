// SPDX-License-Identifier: Apache-2.0
import { createMemo, createSignal, For, Show } from 'solid-js';
import type { Finding } from '../../api/nightTypes';
import { follow } from '../../state/actions';
import { parseId } from '../../state/ids';
import { cursor, selected, setSelected } from '../../state/store';
import { formatClock, formatCount, formatDate } from '../../time/format';
import { findingText, kindText } from './told';

/** Findings that are listed at first; the others come by a button. */
const kShown = 100;

/** What a reflection found: each leads to its moment and to its entity. */
export function Findings(props: { findings: readonly Finding[] }) {
  const [kind, setKind] = createSignal('');
  const [isAll, setAll] = createSignal(false);
  const kinds = createMemo(() => { const counts = new Map<string, number>(); for (const one of props.findings) counts.set(one.kind, (counts.get(one.kind) ?? 0) + 1); return [...counts].sort((a, b) => b[1] - a[1]); });
  const chosen = createMemo(() => props.findings.filter((one) => kind() === '' || one.kind === kind()));
  const shown = () => (isAll() ? chosen() : chosen().slice(0, kShown));
  const timeOf = (finding: Finding) => parseId(finding.first_snapshot).time;
  const clock = (finding: Finding) => { const time = timeOf(finding); return time === undefined ? finding.first_snapshot : `${formatDate(time) === formatDate(cursor()) ? '' : `${formatDate(time)} `}${formatClock(time, 3)}`; };
  return (
    <>
      <Show when={kinds().length > 1}>
        <div class="kinds" role="group" aria-label="Kinds of findings">
          <button class="chip" aria-pressed={kind() === ''} onClick={() => setKind('')}>all {formatCount(props.findings.length)}</button>
          <For each={kinds()}>{([name, count]) => <button class="chip" aria-pressed={kind() === name} onClick={() => setKind(kind() === name ? '' : name)}>{name} {formatCount(count)}</button>}</For>
        </div>
      </Show>
      <ul class="findings" aria-label="Findings">
        <For each={shown()}>{(finding) => (
          <li classList={{ fault: finding.severity === 'fault' }}>
            <button class="chip" title={`Go to ${finding.first_snapshot}`} onClick={() => follow(finding.first_snapshot)}>{clock(finding)}</button>
            <span class="finding-what"><b>{kindText(finding.kind)}</b> <span class="severity">{finding.severity}</span></span>
            <button class="entity-link" classList={{ chosen: selected() === finding.entity }} title={`Choose ${finding.entity}`} onClick={() => setSelected(finding.entity)}>{finding.entity}</button>
            <span class="finding-text">{findingText(finding)}</span>
          </li>
        )}</For>
      </ul>
      <Show when={shown().length < chosen().length}><p class="bar"><button onClick={() => setAll(true)}>Show {formatCount(chosen().length - shown().length)} more</button></p></Show>
    </>
  );
}
