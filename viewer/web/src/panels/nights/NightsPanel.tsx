// SPDX-License-Identifier: Apache-2.0
import { For, Match, Switch } from 'solid-js';
import { getJson } from '../../api/client';
import { nights, type Nights } from '../../api/nightTypes';
import { createRequest } from '../../state/request';
import { info, setOption, type Panel } from '../../state/store';
import { PanelFrame } from '../../ui/PanelFrame';
import { BytesPart } from './BytesPart';
import { ForgettingPart } from './ForgettingPart';
import { NightList } from './NightList';
import { ReflectionPart } from './ReflectionPart';

const kParts = [['bytes', 'Bytes'], ['nights', 'Nights'], ['reflection', 'Reflection'], ['forgetting', 'Forgetting']] as const;

/** What the memory weighs, what nights did to it and found in it, and what forgetting would do. */
export default function NightsPanel(props: { panel: Panel }) {
  const part = () => kParts.find(([name]) => name === props.panel.options.part)?.[0] ?? 'bytes';
  const isOfNights = () => part() === 'bytes' || part() === 'nights';
  const asked = createRequest<Nights>(() => (info() && isOfNights() ? { group: 'nights', run: (signal) => getJson('nights', {}, nights, signal) } : null));
  return (
    <PanelFrame panel={props.panel} icon="moon" title="Nights and bytes" isBusy={asked.isBusy()} error={isOfNights() ? asked.error() : ''} onRetry={asked.retry}
      actions={<span class="segments" role="group" aria-label="Parts of nights and bytes"><For each={kParts}>{([name, title]) => <button aria-pressed={part() === name} onClick={() => setOption(props.panel, 'part', name)}>{title}</button>}</For></span>}>
      <Switch>
        <Match when={part() === 'bytes'}><BytesPart asked={asked} /></Match>
        <Match when={part() === 'nights'}><NightList asked={asked} /></Match>
        <Match when={part() === 'reflection'}><ReflectionPart /></Match>
        <Match when={part() === 'forgetting'}><ForgettingPart panel={props.panel} /></Match>
      </Switch>
    </PanelFrame>
  );
}
