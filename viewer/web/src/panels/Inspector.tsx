// SPDX-License-Identifier: Apache-2.0
import { createEffect, createMemo, createSignal, For, Index, onCleanup, Show } from 'solid-js';
import { getJson } from '../api/client';
import { links, type Links, type Member, type Moment } from '../api/types';
import { copy, momentQuery, pythonLine } from '../state/actions';
import { setSelectedLinks } from '../state/links';
import { parseId } from '../state/ids';
import { createMembers, createMoment } from '../state/moment';
import { createRequest } from '../state/request';
import { openPanel, selected, type Panel } from '../state/store';
import { formatDuration, formatTime } from '../time/format';
import { IconButton } from '../ui/Icon';
import { LinkChip } from '../ui/LinkChip';
import { Empty, PanelFrame } from '../ui/PanelFrame';
import { SourceTag } from '../ui/SourceTag';
import { createCame, ForetoldPart } from './foretold/ForetoldPart';
import { isTold, ToldPart } from './told/ToldPart';
import { TracePart } from './trace/TracePart';
import { describe } from './values';

/** Everything about the chosen entity's snapshot below the cursor. */
export function Inspector(props: { panel: Panel }) {
  const moment = createMoment(selected);
  const members = createMembers(selected);
  const linked = createRequest<Links & { id: string }>(() => {
    const here = moment.data();
    return here && here.source !== 'predicted' ? { group: 'links', run: async (signal) => ({ id: here.id, ...(await getJson('links', { id: here.id }, links, signal)) }) } : null;
  });
  // A search for links takes longer than a step, and those of another snapshot are not of this one.
  const ownLinks = () => { const found = linked.data(); return found && found.id === moment.data()?.id ? found : undefined; };
  createEffect(() => {
    const found = ownLinks();
    setSelectedLinks(found ? { id: found.id, ids: [...new Set([...found.to.map((one) => one.id), ...found.from])] } : null);
  });
  onCleanup(() => setSelectedLinks(null));
  const came = createCame(selected, moment.data);
  const types = createMemo(() => new Map((members.data() ?? []).map((member) => [member.path, member])));
  return (
    <PanelFrame panel={props.panel} icon="list-tree" title="Inspector" entity={selected()} isBusy={moment.isBusy()} error={moment.error() || linked.error()} onRetry={moment.error() ? moment.retry : linked.retry}
      actions={<Show when={moment.data()}>{(here) => <>
        <IconButton icon="copy" label="Copy the ID of this snapshot" onClick={() => void copy(here().id, 'the ID')} />
        <IconButton icon="terminal" label="Copy the query of this snapshot" onClick={() => void copy(momentQuery(selected(), here().time), 'the query')} />
        <IconButton icon="code" label="Copy a line of Python for this snapshot" onClick={() => void copy(pythonLine(selected(), here().time), 'a line of Python')} />
      </>}</Show>}>
      <Show when={selected()} fallback={<Empty title="No entity is chosen">Click a lane, or press / and type a name.</Empty>}>
        <Show when={moment.data()} fallback={<Show when={!moment.error()}><div class="skeleton tall" /></Show>}>
          {(here) => <>
            <Facts moment={here()} />
            <Show when={came()}>{(both) => <ForetoldPart came={both()} />}</Show>
            <Show when={isTold(selected()) && parseId(here().id).entity === selected() && here().source !== 'predicted'}><ToldPart moment={here()} /></Show>
            <Show when={ownLinks()}>{(found) => <Chips links={found()} />}</Show>
            <Show when={here().source !== 'predicted'}><TracePart panel={props.panel} id={here().id} /></Show>
            <Index each={here().instances}>{(instance) => (
              <div class="tree" role="tree" aria-label={`Value of instance ${instance().index}`}>
                <Show when={here().instances.length > 1}><p class="instance">Instance {instance().index}</p></Show>
                <Nodes value={instance().data} path="" depth={0} entity={selected()} time={here().time} types={types()} />
              </div>
            )}</Index>
            <Metadata moment={here()} />
          </>}
        </Show>
      </Show>
    </PanelFrame>
  );
}

function Facts(props: { moment: Moment }) {
  return (
    <dl class="facts">
      <dt>Time</dt><dd>{formatTime(props.moment.time)}</dd>
      <dt>Source</dt><dd><SourceTag source={props.moment.source} /> {props.moment.engine ?? props.moment.model ?? ''}</dd>
      <Show when={props.moment.horizon !== undefined}><dt>Horizon</dt><dd>+{formatDuration(props.moment.horizon!)}</dd></Show>
      <Show when={props.moment.expected_error !== undefined}><dt>{props.moment.source === 'predicted' ? 'Expected error' : 'Error'}</dt><dd>{props.moment.expected_error!.toPrecision(3)}</dd></Show>
      <Show when={props.moment.bound !== undefined}><dt>Bound (90 %)</dt><dd>{props.moment.bound!.toPrecision(3)}</dd></Show>
      <Show when={props.moment.previous !== undefined || props.moment.next !== undefined}><dt>Steps</dt>
        <dd>{props.moment.previous === undefined ? 'first' : `${formatDuration(props.moment.time - props.moment.previous)} after the last`}{props.moment.next === undefined ? ', newest' : `, next in ${formatDuration(props.moment.next - props.moment.time)}`}</dd></Show>
    </dl>
  );
}

function Chips(props: { links: Links }) {
  const kFew = 6;
  const [isAll, setAll] = createSignal(false);
  const any = () => props.links.to.length + props.links.from.length > 0;
  // The eyes of a stereo pair link to the same joints.
  const to = () => props.links.to.filter((link, i, all) => all.findIndex((other) => other.id === link.id) === i);
  const from = () => (isAll() ? props.links.from : props.links.from.slice(0, Math.max(0, kFew - to().length)));
  const more = () => props.links.from.length - from().length;
  return (
    <Show when={any()}>
      <div class="chips" role="group" aria-label="Links of this snapshot">
        <For each={to()}>{(link) => <LinkChip id={link.id} direction="to" path={link.path} />}</For>
        <For each={from()}>{(id) => <LinkChip id={id} direction="from" path="" />}</For>
        <Show when={more() > 0}><button class="chip" onClick={() => setAll(true)}>and {more()} more</button></Show>
      </div>
    </Show>
  );
}

interface NodesProps {
  path: string; value: unknown; depth: number; entity: string; time: bigint; types: ReadonlyMap<string, Member>;
}

const kMaxNodes = 512;

/** What is in a value, or the value where nothing is in it. By place, so that what is open stays open in the next snapshot. */
function Nodes(props: NodesProps) {
  const parts = createMemo(() => {
    const { children } = describe(props.value, props.path);
    return children.length === 0 && props.depth === 0 ? [{ key: 'value', path: '', value: props.value }] : children;
  });
  return (
    <>
      <Index each={parts().slice(0, kMaxNodes)}>{(part) => <Node {...props} name={part().key} path={part().path} value={part().value} />}</Index>
      <Show when={parts().length > kMaxNodes}><p class="muted">and {parts().length - kMaxNodes} more</p></Show>
    </>
  );
}

function Node(props: NodesProps & { name: string }) {
  const value = createMemo(() => describe(props.value, props.path));
  const [isOpen, setOpen] = createSignal(props.depth < 1 && value().children.length <= 8);
  const type = () => props.types.get(props.path);
  const isGroup = () => value().children.length > 0;
  const onKey = (event: KeyboardEvent) => {
    if (event.target !== event.currentTarget) return;
    if (event.key === 'ArrowRight' && isGroup()) setOpen(true);
    else if (event.key === 'ArrowLeft' && isGroup()) setOpen(false);
    else if (event.key === 'Enter' && isGroup()) setOpen(!isOpen());
    else if (event.key === 'ArrowDown' || event.key === 'ArrowUp') {
      const all = [...(event.currentTarget as HTMLElement).closest('.panel-body')!.querySelectorAll<HTMLElement>('.node')];
      all[all.indexOf(event.currentTarget as HTMLElement) + (event.key === 'ArrowDown' ? 1 : -1)]?.focus();
    } else return;
    event.preventDefault();
    event.stopPropagation();
  };
  return (
    <>
      <div class="node" role="treeitem" tabindex="0" aria-level={props.depth + 1} aria-expanded={isGroup() ? isOpen() : undefined} aria-selected="false" style={{ 'padding-left': `${6 + props.depth * 14}px` }} onKeyDown={onKey}>
        <span class="twist" onClick={() => setOpen(!isOpen())} aria-hidden="true">{isGroup() ? (isOpen() ? '▾' : '▸') : ''}</span>
        <span class="key" onClick={() => setOpen(!isOpen())}>{props.name}<Show when={type()?.name}><small>{type()!.name}</small></Show></span>
        <Show when={value().link} fallback={<span class={`value ${value().kind}`} title={value().text}>{value().text}<Show when={type()?.unit && value().kind === 'number'}><span class="unit"> {type()!.unit}</span></Show></span>}>
          <span class="value"><LinkChip id={value().link!} direction="to" path="" /></span>
        </Show>
        <span class="type">{value().type}</span>
        <span class="node-actions">
          <Show when={value().kind === 'number'}><IconButton icon="chart-line" label={`Plot ${props.path}`} onClick={() => openPanel('plot', props.entity, [props.path])} /></Show>
          <IconButton icon="copy" label={`Copy the path ${props.path}`} onClick={() => void copy(props.path, 'the path')} />
          <IconButton icon="code" label={`Copy a line of Python for ${props.path}`} onClick={() => void copy(pythonLine(props.entity, props.time, props.path), 'a line of Python')} />
        </span>
      </div>
      <Show when={isOpen() && isGroup()}><Nodes {...props} depth={props.depth + 1} /></Show>
    </>
  );
}

function Metadata(props: { moment: Moment }) {
  const rows = () => Object.entries((props.moment.instances[0]?.metadata ?? {}) as Record<string, unknown>);
  const text = (key: string, value: unknown) => (/^(created|sent|arrived)/.test(key) && typeof value === 'string' && /^-?\d+$/.test(value) ? formatTime(BigInt(value)) : String(value));
  return (
    <details class="metadata"><summary>Metadata</summary>
      <dl class="facts"><For each={rows()}>{([key, value]) => <><dt>{key}</dt><dd>{text(key, value)}</dd></>}</For></dl>
    </details>
  );
}
