// SPDX-License-Identifier: Apache-2.0
import { beforeEach, describe, expect, it } from 'vitest';
import { exportCommand, pythonLine } from './actions';
import { setInfo, setSelected, setSelection } from './store';

const info = { name: 'm', version: '1', first: 0n, last: 10n, entities: 1, snapshots: 1, is_live: false, max_horizon_ns: 1n };

describe('what is copied', () => {
  beforeEach(() => {
    setSelected("A/B/C/it's; $(rm)");
    setSelection({ from: 0n, to: 1_000n });
  });
  it('of a store is a command that a shell takes as it is', () => {
    setInfo({ ...info, stores: [{ name: 'x.engram', path: "/data/a 'b'.engram" }] });
    expect(exportCommand()).toBe(String.raw`engram export '/data/a '\''b'\''.engram' 'A/B/C/it'\''s\; \$\(rm\) @ 1970-01-01 00:00:00.000000..1970-01-01 00:00:00.000001' --to jsonl -o exported`);
    expect(pythonLine('A/B/C/D', 5n, 'p[1]')).toBe(String.raw`engram.open("/data/a 'b'.engram")["A/B/C/D"].at(5).value["p"][1]`);
  });
  it('of a server asks the server', () => {
    setInfo({ ...info, stores: [{ name: '127.0.0.1:50051', path: undefined }] });
    expect(exportCommand()).toMatch(/^engram query --server 127\.0\.0\.1:50051 'A.* --json$/);
    expect(pythonLine('A/B/C/D', 5n)).toBe('engram.connect("127.0.0.1:50051")["A/B/C/D"].at(5).value');
  });
});
