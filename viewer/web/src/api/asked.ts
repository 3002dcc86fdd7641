// SPDX-License-Identifier: Apache-2.0
// Answers to questions in words, and narrations.
import * as d from './decode';

export const answer = d.object({
  text: d.string,
  route: d.string,
  confidence: d.number,
  program: d.withDefault(d.string, ''),
  value: d.object({ kind: d.string }),
  evidence: d.list(d.object({ id: d.string, role: d.withDefault(d.string, '') })),
  looked_for: d.withDefault(d.string, ''),
  took_ms: d.number,
});
export type Answer = d.Of<typeof answer>;

export const narration = d.object({ sentences: d.list(d.object({ level: d.string, text: d.string, links: d.list(d.string) })) });
