// SPDX-License-Identifier: Apache-2.0
// What the colours and signs of outcomes mean.
import { For } from 'solid-js';
import { kOutcomes, type Outcome } from './executions';
import { pathOf } from './glyphs';

/** The sign of an outcome, as bars have it. */
export function OutcomeSign(props: { outcome: Outcome }) {
  const shape = () => pathOf(props.outcome);
  return <svg class={`outcome-sign sign-${props.outcome}`} classList={{ filled: shape().isFilled }} viewBox="0 0 12 12" aria-hidden="true"><path d={shape().d} /></svg>;
}

export function OutcomeLegend() {
  return <span class="legend outcomes" aria-label="Outcomes of skills"><For each={kOutcomes}>{(outcome) => <span class="key"><OutcomeSign outcome={outcome} />{outcome}</span>}</For></span>;
}
