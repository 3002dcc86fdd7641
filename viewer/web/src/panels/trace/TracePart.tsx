// SPDX-License-Identifier: Apache-2.0
import { createEffect, createMemo, createSignal, For, Show } from 'solid-js';
import { getJson } from '../../api/client';
import { links } from '../../api/types';
import { follow } from '../../state/actions';
import { parseId, shortName, splitLevels, nameOf } from '../../state/ids';
import { isMoving } from '../../state/moving';
import { createRequest } from '../../state/request';
import { setOption, type Panel } from '../../state/store';
import { formatDuration } from '../../time/format';
import { downloadSvg } from '../../ui/download';
import { IconButton } from '../../ui/Icon';
import { svgOf } from '../../ui/svgOf';
import { theme } from '../../ui/theme';
import { followLinks, keyOfId, kMaxDepth, kMaxNodes, type Trace, type TraceEdge } from './follow';
import { arrowPath, kNodeHeight, kNodeWidth, neighbourOf, placeTrace, type PlacedNode } from './layout';

const kMaxLetters = 20;

const askLinks = (id: string, signal: AbortSignal) => getJson('links', { id }, links, signal);

/** What led to a snapshot and what it led to, as a graph; asked for while it is open and the cursor rests. */
export function TracePart(props: { panel: Panel; id: string }) {
  const isOpen = () => props.panel.options.trace === '1';
  const restId = createMemo<string>((before) => (!isMoving() || props.id === before ? props.id : ''), '');
  const [growing, setGrowing] = createSignal<Trace | null>(null);
  const asked = createRequest<Trace>(() => {
    const id = restId();
    return isOpen() && id !== '' && id === props.id ? { group: id, run: (signal) => followLinks(id, askLinks, setGrowing, signal) } : null;
  });
  // What grows may be of the snapshot before this one.
  const trace = createMemo(() => [asked.data(), asked.isBusy() ? growing() : null].find((one) => one?.root === keyOfId(props.id)));
  return (
    <details class="trace" open={isOpen()} onToggle={(event) => { if (event.currentTarget.open !== isOpen()) setOption(props.panel, 'trace', event.currentTarget.open ? '1' : '0'); }}>
      <summary>Trace<Show when={isOpen() && asked.isBusy()}><span class="muted" role="status"> following links ...</span></Show></summary>
      <Show when={isOpen()}>
        <Show when={asked.error()}><div class="failure" role="alert"><p>{asked.error()}</p><button onClick={asked.retry}>Try again</button></div></Show>
        <Show when={trace()} fallback={<Show when={!asked.error()}><div class="skeleton trace-wait" /></Show>}>
          {(shown) => <Show when={shown().nodes.length > 1} fallback={<p class="trace-hint">{asked.isBusy() ? '' : 'This snapshot links to nothing, and nothing links to it.'}</p>}><Graph trace={shown()} isWhole={!asked.isBusy()} /></Show>}
        </Show>
      </Show>
    </details>
  );
}

const titleOf = (id: string): string => { const { entity } = parseId(id); const levels = splitLevels(entity); return levels.length > 2 ? `${nameOf(levels.at(-2)!)}/${shortName(entity)}` : entity; };
const shorten = (text: string): string => (text.length > kMaxLetters ? `…${text.slice(1 - kMaxLetters)}` : text);

/** `2.3 s before`, as seen from the first snapshot. */
function awayOf(id: string, root: string): string {
  const [time, from] = [parseId(id).time, parseId(root).time];
  if (time === undefined || from === undefined) return 'no time';
  return time === from ? 'same time' : time < from ? `${formatDuration(from - time)} before` : `${formatDuration(time - from)} after`;
}

/** True once a person went along the graph, so that the focus stays in it when the next one comes. */
let keepsFocus = false;

function Graph(props: { trace: Trace; isWhole: boolean }) {
  const placed = createMemo(() => placeTrace(props.trace));
  const [current, setCurrent] = createSignal('');
  const focusable = () => (placed().nodes.some((node) => node.key === current()) ? current() : props.trace.root);
  let host!: SVGSVGElement;
  let scroller!: HTMLDivElement;
  const node = (key: string) => placed().nodes.find((one) => one.key === key)!;
  const focus = (key: string) => { setCurrent(key); host.querySelector<SVGGElement>(`[data-key="${CSS.escape(key)}"]`)?.focus(); };
  createEffect(() => {
    const root = node(props.trace.root);
    scroller.scrollLeft = root.x + kNodeWidth / 2 - scroller.clientWidth / 2;
    scroller.scrollTop = root.y + kNodeHeight / 2 - scroller.clientHeight / 2;
    if (keepsFocus && props.isWhole) { keepsFocus = false; focus(root.key); }
  });
  const go = (one: PlacedNode) => {
    if (one.key === props.trace.root) return;
    keepsFocus = parseId(one.id).time !== undefined;
    follow(one.id);
  };
  const onKey = (event: KeyboardEvent, one: PlacedNode) => {
    if (event.altKey || event.ctrlKey || event.metaKey) return;
    const next = neighbourOf(placed(), props.trace, one.key, event.key);
    if (next) focus(next.key);
    else if (event.key === 'Enter' || event.key === ' ') go(one);
    else if (!event.key.startsWith('Arrow')) return;
    event.preventDefault();
    event.stopPropagation();
  };
  const told = (edge: TraceEdge) => `${node(edge.effect).id} links to ${node(edge.cause).id}${edge.paths.length > 0 ? `\n${edge.paths.join(', ')}` : ''}`;
  const below = (one: PlacedNode) => (one.problem ? 'links not known' : one.key === props.trace.root ? 'this snapshot' : awayOf(one.id, node(props.trace.root).id));
  // Begins with what is written in the node, as those who speak to their browser need it.
  const label = (one: PlacedNode) => `${shorten(titleOf(one.id))} ${below(one)}, ${one.key === props.trace.root ? '' : 'go to '}${one.id}${one.problem ? `; its links are not known: ${one.problem}` : !one.isFollowed && props.isWhole && parseId(one.id).time !== undefined ? '; not followed further' : ''}`;
  const problems = () => props.trace.nodes.filter((one) => one.problem !== '').length;
  return (
    <>
      <div class="trace-scroll" ref={scroller}>
        <svg class="trace-graph" ref={host} role="group" aria-label={`Trace: ${props.trace.nodes.length} snapshots from causes on the left to consequences on the right`} width={placed().width} height={placed().height} viewBox={`0 0 ${placed().width} ${placed().height}`}>
          <defs><marker id="trace-head" viewBox="0 0 8 8" refX="1" refY="4" markerWidth="8" markerHeight="8" markerUnits="userSpaceOnUse" orient="auto"><path class="trace-head" d="M0 0L8 4L0 8Z" /></marker></defs>
          <For each={props.trace.edges}>{(edge) => (
            <g class="trace-edge" classList={{ near: edge.cause === focusable() || edge.effect === focusable() }}>
              <title>{told(edge)}</title>
              <path class="trace-line" d={arrowPath(placed(), node(edge.cause), node(edge.effect))} marker-end="url(#trace-head)" />
              <path class="trace-reach" d={arrowPath(placed(), node(edge.cause), node(edge.effect))} />
            </g>
          )}</For>
          <For each={placed().nodes}>{(one) => (
            <g class="trace-node" classList={{ root: one.key === props.trace.root, broken: one.problem !== '', rim: !one.isFollowed }} role="button" tabindex={one.key === focusable() ? 0 : -1} aria-label={label(one)} data-key={one.key}
              aria-current={one.key === props.trace.root ? 'true' : undefined} onClick={() => go(one)} onFocus={() => setCurrent(one.key)} onKeyDown={(event) => onKey(event, one)} transform={`translate(${one.x} ${one.y})`}>
              <title>{label(one)}</title>
              <rect width={kNodeWidth} height={kNodeHeight} rx="6" />
              <text><tspan class="trace-name" x="8" y="14">{shorten(titleOf(one.id))}</tspan>{' '}<tspan class="trace-away" x="8" y="27">{below(one)}</tspan></text>
            </g>
          )}</For>
        </svg>
      </div>
      <div class="trace-foot">
        <p class="trace-hint" hidden={!props.isWhole}>
          <Show when={props.trace.isCut || props.trace.omitted > 0}>Cut off: {props.trace.omitted > 0 ? `${props.trace.omitted} more links are not shown; ` : ''}at most {kMaxDepth} links far and {kMaxNodes} snapshots are followed. </Show>
          <Show when={problems() > 0}>The links of {problems()} of them could not be read.</Show>
        </p>
        <IconButton icon="pen-tool" label="Save the trace as SVG" onClick={() => downloadSvg(svgOf(host, `Trace of ${props.trace.root}`, theme().panel), 'trace.svg')} />
      </div>
    </>
  );
}
