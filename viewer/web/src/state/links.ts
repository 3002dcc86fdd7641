// SPDX-License-Identifier: Apache-2.0
// The links of the snapshot that the inspector shows; the timeline draws them between lanes.
import { createSignal } from 'solid-js';

export interface ShownLinks {
  readonly id: string;
  readonly ids: readonly string[];
}

export const [selectedLinks, setSelectedLinks] = createSignal<ShownLinks | null>(null);
