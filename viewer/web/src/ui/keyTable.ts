// SPDX-License-Identifier: Apache-2.0
import { copyExport, copyLink, goFirst, goFuture, goLast, selectFrom, selectSpan, showAll, stepBy, zoomBy } from '../state/actions';
import { togglePlay } from '../state/play';
import { entities, openPanel, selected, setSelected, setView, limits, view } from '../state/store';
import { pan } from '../time/span';
import type { Key } from './keys';

const ten = (event: { shiftKey: boolean }): number => (event.shiftKey ? 10 : 1);

function chooseLane(by: number): void {
  const all = entities();
  const here = all.findIndex((node) => node.id === selected());
  const next = all[Math.max(0, Math.min(all.length - 1, here + by))];
  if (next) setSelected(next.id);
}

export const keyTable = (open: (dialog: 'search' | 'help' | 'time') => void, close: () => void): readonly Key[] => [
  { keys: [' '], shown: 'space', what: 'play, pause', run: togglePlay },
  { keys: ['ArrowRight'], shown: '→', what: 'next snapshot of the chosen entity; with shift ten', run: (event) => void stepBy(ten(event)) },
  { keys: ['ArrowLeft'], shown: '←', what: 'previous snapshot; with shift ten', run: (event) => void stepBy(-ten(event)) },
  { keys: ['ArrowDown'], shown: '↓', what: 'next lane; with shift ten', run: (event) => chooseLane(ten(event)) },
  { keys: ['ArrowUp'], shown: '↑', what: 'lane above; with shift ten', run: (event) => chooseLane(-ten(event)) },
  { keys: ['+', '='], shown: '+', what: 'zoom in at the cursor', run: () => zoomBy(0.5) },
  { keys: ['-', '_'], shown: '−', what: 'zoom out', run: () => zoomBy(2) },
  { keys: ['0'], shown: '0', what: 'the whole life', run: showAll },
  { keys: [',', '<'], shown: ',', what: 'a screen back; with shift ten', run: (event) => setView(pan(view(), -500 * ten(event), 1000, limits())) },
  { keys: ['.', '>'], shown: '.', what: 'a screen on; with shift ten', run: (event) => setView(pan(view(), 500 * ten(event), 1000, limits())) },
  { keys: ['Home'], shown: 'Home', what: 'first snapshot', run: goFirst },
  { keys: ['End'], shown: 'End', what: 'last snapshot', run: goLast },
  { keys: ['f'], shown: 'f', what: 'into the future: 400 ms behind the last snapshot', run: goFuture },
  { keys: ['g'], shown: 'g', what: 'go to a time', run: () => open('time') },
  { keys: ['['], shown: '[', what: 'selection begins at the cursor', run: () => selectFrom('from') },
  { keys: [']'], shown: ']', what: 'selection ends at the cursor', run: () => selectFrom('to') },
  { keys: ['e'], shown: 'e', what: 'copy engram export for the selection', run: () => void copyExport() },
  { keys: ['l'], shown: 'l', what: 'copy a link to this view', run: () => void copyLink() },
  { keys: ['i'], shown: 'i', what: 'images of the chosen entity', run: () => { if (selected()) openPanel('images', selected()); } },
  { keys: ['p'], shown: 'p', what: 'plot of the chosen entity', run: () => { if (selected()) openPanel('plot', selected()); } },
  { keys: ['s'], shown: 's', what: 'moments similar to this one', run: () => { if (selected()) openPanel('similar', selected()); } },
  { keys: ['m'], shown: 'm', what: 'the memory map of the chosen entity', run: () => { if (selected()) openPanel('map', selected()); } },
  { keys: ['n'], shown: 'n', what: 'nights and bytes', run: () => void openPanel('nights', '') },
  { keys: ['a'], shown: 'a', what: 'ask in English, or have it told', run: () => void openPanel('ask', '') },
  { keys: ['q'], shown: 'q', what: 'query', run: () => void openPanel('query', '') },
  { keys: ['3'], shown: '3', what: 'the scene in 3-D', run: () => void openPanel('scene', '') },
  { keys: ['/'], shown: '/', what: 'search entities', run: () => open('search') },
  { keys: ['?'], shown: '?', what: 'this help', run: () => open('help') },
  { keys: ['Escape'], shown: 'Esc', what: 'close, clear the selection', run: () => { close(); selectSpan(null); } },
];
