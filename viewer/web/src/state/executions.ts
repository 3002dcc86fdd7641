// SPDX-License-Identifier: Apache-2.0
// The executions of skills that the timeline shows, and the one that was clicked.
import { createSignal } from 'solid-js';
import type { Execution } from '../skills/executions';

export interface ExecutionKey {
  readonly entity: string;
  readonly start: bigint;
}

/** What was clicked; it holds while its lane is chosen and the cursor lies in it. Null: what the cursor tells. */
export const [clicked, setClicked] = createSignal<ExecutionKey | null>(null);
/** What the inspector tells of. */
export const [toldExecution, setToldExecution] = createSignal<ExecutionKey | null>(null);
/** Those on the screen, by the entity that they are kept in. */
export const [onScreen, setOnScreen] = createSignal<ReadonlyMap<string, readonly Execution[]>>(new Map());
