// SPDX-License-Identifier: Apache-2.0
import { createSignal, Show, type JSX } from 'solid-js';
import { closePanel, heightOf, kPanelRange, movePanel, neighboursOf, selected, setHeight, setSelected, type Panel } from '../state/store';
import { dragged, startDrag, tellPlace } from './drag';
import { Icon, IconButton, type IconName } from './Icon';
import { HeightHandle } from './Splitter';

export interface FrameProps {
  readonly panel: Panel;
  readonly icon: IconName;
  readonly title: string;
  /** What is shown, where the panel follows the chosen entity. */
  readonly entity?: string;
  readonly isBusy?: boolean;
  /** What went wrong and what to do; shown above the body, which has what is still known. */
  readonly error?: string;
  readonly onRetry?: () => void;
  readonly actions?: JSX.Element;
  readonly children: JSX.Element;
}

/** Head and body of a panel: title, its own buttons, moving and closing, errors as text. */
export function PanelFrame(props: FrameProps) {
  const entity = () => props.entity ?? props.panel.entity;
  const all = () => neighboursOf(props.panel.key);
  const place = () => all().findIndex((panel) => panel.key === props.panel.key);
  let bar!: HTMLElement;
  let section!: HTMLElement;
  const move = (by: number) => { if (movePanel(props.panel.key, by)) tellPlace(props.panel.key, props.title); };
  const onKey = (event: KeyboardEvent) => {
    if (!event.altKey || !event.shiftKey || event.ctrlKey || event.metaKey) return;
    const by = event.key === 'ArrowLeft' || event.key === 'ArrowUp' ? -1 : event.key === 'ArrowRight' || event.key === 'ArrowDown' ? 1 : 0;
    if (by === 0) return;
    event.preventDefault();
    event.stopPropagation();
    move(by);
    // What moves in the page loses the focus.
    bar.focus();
  };
  // The height that it has by itself is measured when somebody asks for another one.
  const [own, setOwn] = createSignal(0);
  const measure = () => setOwn(Math.round(section.getBoundingClientRect().height));
  return (
    <section ref={section} class={`panel panel-${props.panel.kind}`} classList={{ dragged: dragged()?.key === props.panel.key }} aria-label={`${props.title} ${props.panel.entity}`} data-panel={props.panel.kind}
      onPointerEnter={measure} onFocusIn={measure}>
      <header class="panel-head" ref={bar} tabindex="0" role="group" aria-label={`Title bar of ${props.title}, ${place() + 1} of ${all().length}`} aria-keyshortcuts="Alt+Shift+ArrowLeft Alt+Shift+ArrowRight" title="Drag to another place, or press Alt+Shift+arrow"
        onPointerDown={(event) => startDrag(event, props.panel.key, props.title)} onKeyDown={onKey}>
        <Icon name={props.icon} />
        <h2>{props.title}</h2>
        <Show when={entity()}>
          <button class="entity" classList={{ chosen: selected() === entity(), 'entity-path': props.entity !== undefined }} title={`Choose ${entity()}`} onClick={() => setSelected(entity())}><bdi>{entity()}</bdi></button>
        </Show>
        <span class="busy" classList={{ on: props.isBusy ?? false }} role="status" aria-label={props.isBusy ? 'loading' : ''} />
        <span class="panel-actions">
          {props.actions}
          <IconButton icon="arrow-left" label={`Move ${props.title} forward`} isDisabled={place() <= 0} onClick={() => move(-1)} />
          <IconButton icon="arrow-right" label={`Move ${props.title} back`} isDisabled={place() >= all().length - 1} onClick={() => move(1)} />
          <IconButton icon="x" label={`Close ${props.title}`} onClick={() => closePanel(props.panel.key)} />
        </span>
      </header>
      <div class="panel-body">
        <Show when={props.error}>
          <div class="failure" role="alert"><p>{props.error}</p><Show when={props.onRetry}><button onClick={() => props.onRetry?.()}>Try again</button></Show></div>
        </Show>
        {props.children}
      </div>
      <HeightHandle class="panel-foot" label={`Height of ${props.title}`} height={heightOf(props.panel.key) ?? own()} range={kPanelRange} onHeight={(height) => { setHeight(props.panel.key, height); queueMicrotask(measure); }} />
    </section>
  );
}

export function Empty(props: { title: string; children?: JSX.Element }) {
  return <div class="empty"><strong>{props.title}</strong><p>{props.children}</p></div>;
}
