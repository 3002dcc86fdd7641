// SPDX-License-Identifier: Apache-2.0
// The form of a policy of forgetting, and the command that carries it out: nothing in the page can.

export interface Field {
  /** As the gateway calls it, and the address of the page. */
  readonly name: string;
  readonly label: string;
  readonly hint: string;
  readonly title: string;
  readonly size: number;
}

export const kFields: readonly Field[] = [
  { name: 'match', label: 'Entities', hint: 'all', title: 'Names as in a query, such as Vision/RGB; empty: all', size: 16 },
  { name: 'older_than', label: 'Go when older than', hint: '30d', title: 'What is older, by its own time: 12h, 30d', size: 5 },
  { name: 'unread_for', label: 'not read for', hint: '90d', title: 'What was last read longer ago', size: 5 },
  { name: 'keep', label: 'but the most salient', hint: '0.2', title: 'The share that is worth most stays, 0 to 1, by what nights found', size: 4 },
  { name: 'fade_after', label: 'Fade when older than', hint: '7d', title: 'Older images lose quality', size: 5 },
  { name: 'fade_psnr', label: 'to dB or gist', hint: '32', title: 'PSNR that every image keeps, 15 to 60 dB; or gist', size: 4 },
  { name: 'max_bytes', label: 'Store at most', hint: '20GB', title: 'A quota for the whole store: what rules leave fades first, then the oldest goes', size: 7 },
  { name: 'newest', label: 'Keep the newest', hint: '1', title: 'So many of each entity never go', size: 3 },
];

/** What the form says, as parameters of a question; without those that are empty. */
export function paramsOf(options: Readonly<Record<string, string>>): Record<string, string> {
  return Object.fromEntries(kFields.map(({ name }) => [name, (options[name] ?? '').trim()] as const).filter(([, value]) => value !== ''));
}

/** The field that an error of the gateway is about. */
export const fieldOf = (message: string): string | undefined => /^parameter '(\w+)'/.exec(message)?.[1];

/** The same error with the name that the field has on the page. */
export function errorText(message: string): string {
  const field = kFields.find(({ name }) => name === fieldOf(message));
  return field ? message.replace(/^parameter '\w+'/, `“${field.label}”`) : message;
}

/** Names one view of the page, so that its new question takes the place of its old one. */
export const newPageName = (): string => Math.random().toString(36).slice(2, 12);

/** What a person runs in a shell: the configuration as a file, then the command, which asks before it does anything. */
export function forgetCommand(config: string, store: string): string {
  let end = 'END';
  while (config.split('\n').includes(end)) end += '_';
  return `cat > forget.yaml <<'${end}'\n${config.replace(/\n*$/, '\n')}${end}\nengram forget ${store} --config forget.yaml`;
}
