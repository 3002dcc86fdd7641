// SPDX-License-Identifier: Apache-2.0
// Moments that were asked for and still hold, so that a commit or a step of the cursor asks only
// for what it changed.
import type { Moment } from '../../api/types';

/** How an entity is asked for a moment. */
export interface Wanted {
  readonly entity: string;
  readonly at: bigint;
  readonly which: string;
  /** What is known of later commits; an answer holds as long as this stays the same. */
  readonly news: string;
}

interface Entry extends Wanted {
  readonly asked: number;
  readonly promise: Promise<Moment | null>;
  /** Null: there was no snapshot. */
  moment?: Moment | null;
}

export class KeptMoments {
  private readonly entries = new Map<string, Entry>();

  /** `maxAgeMs`: answers that are older are asked for again, because nobody tells what was changed in a store. */
  constructor(private readonly load: (wanted: Wanted, signal: AbortSignal) => Promise<Moment | null>, private readonly now: () => number = () => performance.now()) {}

  async ask(wanted: Wanted, maxAgeMs: number, signal: AbortSignal): Promise<Moment | null> {
    const key = `${wanted.which} ${wanted.entity}`;
    const known = this.entries.get(key);
    if (known && this.now() - known.asked <= maxAgeMs && this.holds(known, wanted)) return known.promise;
    const entry: Entry = { ...wanted, asked: this.now(), promise: this.load(wanted, signal) };
    this.entries.set(key, entry);
    try {
      return (entry.moment = await entry.promise);
    } catch (error) {
      if (this.entries.get(key) === entry) this.entries.delete(key);
      throw error;
    }
  }

  private holds(entry: Entry, { at, news }: Wanted): boolean {
    if (entry.at === at && entry.news === news) return true;
    const { moment } = entry;
    if (moment === undefined || moment?.source === 'predicted') return false;
    // Times of an entity ascend: what comes later lies behind the next snapshot, if there is one.
    if (moment === null) return at <= entry.at && entry.news === news;
    if (at < moment.time) return false;
    return moment.next !== undefined ? at < moment.next : entry.news === news;
  }
}
