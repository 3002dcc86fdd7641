// SPDX-License-Identifier: Apache-2.0
import { createSignal, Show, type JSX } from 'solid-js';
import { closePanel, movePanel, panels, selected, setSelected, type Panel } from '../state/store';
import { Icon, IconButton, type IconName } from './Icon';

/** What is being dragged; the browser does not tell while it hovers. */
const [dragged, setDragged] = createSignal<number | null>(null);

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
  const place = () => panels().findIndex((panel) => panel.key === props.panel.key);
  const drop = () => {
    const from = dragged();
    if (from === null || from === props.panel.key) return;
    movePanel(from, place() - panels().findIndex((panel) => panel.key === from));
    setDragged(null);
  };
  return (
    <section class={`panel panel-${props.panel.kind}`} classList={{ aimed: dragged() !== null && dragged() !== props.panel.key }} aria-label={`${props.title} ${props.panel.entity}`} data-panel={props.panel.kind}
      onDragOver={(event) => { if (dragged() !== null) event.preventDefault(); }} onDrop={drop}>
      <header class="panel-head" draggable="true" onDragStart={() => setDragged(props.panel.key)} onDragEnd={() => setDragged(null)}>
        <Icon name={props.icon} />
        <h2>{props.title}</h2>
        <Show when={entity()}>
          <button class="entity" classList={{ chosen: selected() === entity(), 'entity-path': props.entity !== undefined }} title={`Choose ${entity()}`} onClick={() => setSelected(entity())}><bdi>{entity()}</bdi></button>
        </Show>
        <span class="busy" classList={{ on: props.isBusy ?? false }} role="status" aria-label={props.isBusy ? 'loading' : ''} />
        <span class="panel-actions">
          {props.actions}
          <IconButton icon="arrow-left" label={`Move ${props.title} forward`} isDisabled={place() <= 0} onClick={() => movePanel(props.panel.key, -1)} />
          <IconButton icon="arrow-right" label={`Move ${props.title} back`} isDisabled={place() >= panels().length - 1} onClick={() => movePanel(props.panel.key, 1)} />
          <IconButton icon="x" label={`Close ${props.title}`} onClick={() => closePanel(props.panel.key)} />
        </span>
      </header>
      <div class="panel-body">
        <Show when={props.error}>
          <div class="failure" role="alert"><p>{props.error}</p><Show when={props.onRetry}><button onClick={() => props.onRetry?.()}>Try again</button></Show></div>
        </Show>
        {props.children}
      </div>
    </section>
  );
}

export function Empty(props: { title: string; children?: JSX.Element }) {
  return <div class="empty"><strong>{props.title}</strong><p>{props.children}</p></div>;
}
