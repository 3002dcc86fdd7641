// SPDX-License-Identifier: Apache-2.0
// One table of keys: it is listened to, and the help shows it.

export interface Key {
  /** As KeyboardEvent.key has it. */
  readonly keys: readonly string[];
  readonly shown: string;
  readonly what: string;
  readonly run: (event: { readonly shiftKey: boolean }) => void;
}

/** Inside of a text field keys write; dialogs and lists have keys of their own. */
export const isTyping = (target: EventTarget | null): boolean => {
  const element = target as { tagName?: string; isContentEditable?: boolean; type?: string } | null;
  if (!element?.tagName) return false;
  if (element.isContentEditable || element.tagName === 'TEXTAREA' || element.tagName === 'SELECT') return true;
  return element.tagName === 'INPUT' && element.type !== 'checkbox';
};

interface Pressed {
  readonly key: string;
  readonly shiftKey: boolean;
  readonly ctrlKey: boolean;
  readonly metaKey: boolean;
  readonly altKey: boolean;
  readonly target: EventTarget | null;
}

/** The entry that a pressed key means, or undefined. */
export function keyOf(table: readonly Key[], event: Pressed): Key | undefined {
  if (event.ctrlKey || event.metaKey || event.altKey || isTyping(event.target)) return undefined;
  const tag = (event.target as { tagName?: string } | null)?.tagName;
  // A button that has the focus is pressed by these itself.
  if ((event.key === ' ' || event.key === 'Enter') && (tag === 'BUTTON' || tag === 'SUMMARY' || tag === 'INPUT' || tag === 'A')) return undefined;
  const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
  return table.find((entry) => entry.keys.includes(key));
}
