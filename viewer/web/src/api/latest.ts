// SPDX-License-Identifier: Apache-2.0
// Keeps a panel from asking more than it can show.

/**
 * Runs one task at a time; of those that come meanwhile only the latest is kept.
 *
 * While somebody drags the cursor, a task that is under way is let finish, so that pictures go on
 * coming: to abort each for the next would show nothing until the hand rests. A task of another
 * `group` (another entity, another form) is of no use any more, and is aborted at once.
 */
export class Latest<T> {
  private running: { group: string; abort: AbortController } | null = null;
  private waiting: { group: string; task: (signal: AbortSignal) => Promise<T> } | null = null;
  private isClosed = false;

  constructor(
    private readonly onResult: (result: T) => void,
    private readonly onError: (error: unknown) => void,
    private readonly onBusy: (isBusy: boolean) => void = () => {},
  ) {}

  run(group: string, task: (signal: AbortSignal) => Promise<T>): void {
    if (this.isClosed) return;
    this.waiting = { group, task };
    if (this.running === null) this.startNext();
    else if (this.running.group !== group) {
      this.running.abort.abort();
      this.running = null;
      this.startNext();
    }
  }

  /** Drops what runs and what waits; nothing is reported any more. */
  cancel(): void {
    this.running?.abort.abort();
    this.running = null;
    this.waiting = null;
    this.onBusy(false);
  }

  close(): void {
    this.cancel();
    this.isClosed = true;
  }

  private startNext(): void {
    const next = this.waiting;
    if (next === null) return this.onBusy(false);
    this.waiting = null;
    const mine = { group: next.group, abort: new AbortController() };
    this.running = mine;
    this.onBusy(true);
    next.task(mine.abort.signal).then(
      (result) => this.finish(mine, () => this.onResult(result)),
      (error: unknown) => this.finish(mine, () => { if (this.waiting === null) this.onError(error); }),
    );
  }

  private finish(mine: { abort: AbortController }, report: () => void): void {
    if (this.running !== mine) return; // aborted for another group
    this.running = null;
    report();
    this.startNext();
  }
}
