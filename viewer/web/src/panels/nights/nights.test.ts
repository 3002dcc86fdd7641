// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { forgetPlan, nights, reflection } from '../../api/nightTypes';
import { kLaneHeight, lanePaths, sharesOf, sumOf } from './lanes';
import { errorText, fieldOf, forgetCommand, paramsOf } from './policy';
import { changeText, findingsText, findingText, modelsText, nightText, untilOf } from './told';

const night = (began: string, more: object = {}) => ({ work: 'consolidate', began, ended: '9000000000', bytes_before: 100, bytes_after: 60, entities: [], ...more });
const decoded = (...all: object[]) => nights({ entities: [], nights: all }, '').nights;

describe('a lane', () => {
  it('shows of each stretch which share goes, fades and stays', () => {
    expect(sharesOf(0, 0, 5)).toEqual([{ top: 0, bottom: 0 }, { top: 0, bottom: 0 }, { top: 0, bottom: kLaneHeight }]);
    expect(sharesOf(1, 0, 1).map((share) => share.bottom - share.top)).toEqual([8, 0, 8]);
    expect(sharesOf(0, 0, 0).every((share) => share.top === share.bottom)).toBe(true);
  });
  it('shows what is little, and fills the lane', () => {
    for (const [gone, fades, stays] of [[1, 0, 100_000], [100_000, 1, 1], [1, 1, 1], [5, 3, 7]] as const) {
      const shares = sharesOf(gone, fades, stays);
      expect(shares[0].top).toBe(0);
      expect(shares[2].bottom).toBe(kLaneHeight);
      shares.forEach((share, i) => expect(share.bottom - share.top >= ([gone, fades, stays][i]! > 0 ? 2 : 0)).toBe(true));
    }
  });
  it('draws equal neighbours as one, and nothing where nothing is', () => {
    expect(lanePaths({ stays: [3, 9, 0, 2], fades: [0, 0, 0, 0], gone: [0, 0, 4, 0] })).toEqual({ gone: 'M2 0H3V16H2Z', fades: '', stays: 'M0 0H2V16H0ZM3 0H4V16H3Z' });
    expect(sumOf([{ stays: [1, 2], fades: [0, 1], gone: [] }, { stays: [4, 0], fades: [], gone: [1, 1] }], 2)).toEqual({ stays: [5, 2], fades: [0, 1], gone: [1, 1] });
  });
});

describe('a policy', () => {
  it('is asked for without empty fields', () => {
    expect(paramsOf({ match: ' Vision ', older_than: '', keep: '  ', part: 'forgetting', newest: '2' })).toEqual({ match: 'Vision', newest: '2' });
  });
  it('names the field that is wrong', () => {
    expect(fieldOf("parameter 'older_than': found 'x', needs a duration")).toBe('older_than');
    expect(fieldOf("policy:3: 'rules': needs a list")).toBeUndefined();
    expect(errorText("parameter 'older_than': found 'x', needs a duration")).toBe("“Go when older than”: found 'x', needs a duration");
    expect(errorText('data loss')).toBe('data loss');
  });
  it('becomes a command, whatever is in it', () => {
    expect(forgetCommand('forget:\n  rules: []', "'a b.engram'")).toBe("cat > forget.yaml <<'END'\nforget:\n  rules: []\nEND\nengram forget 'a b.engram' --config forget.yaml");
    expect(forgetCommand('a: 1\nEND\nrm -rf ~\n', 's').split('\n')).toEqual(["cat > forget.yaml <<'END_'", 'a: 1', 'END', 'rm -rf ~', 'END_', 'engram forget s --config forget.yaml']);
  });
});

describe('a night', () => {
  it('is told in a line', () => {
    const entity = { id: 'A/B/C/D', encoded: 1200, dropped: 40, waiting: 1, models_added: [3], models_removed: [2] };
    const [one, none] = decoded(night('1', { entities: [entity] }), night('2'));
    expect(nightText(one!)).toBe('1 200 snapshots encoded, 1 new model, 40 left as latents alone, 1 waiting');
    expect(nightText(none!)).toBe('nothing was to be done');
    expect(modelsText(one!.entities[0]!)).toBe('+v3 −v2');
    expect([changeText(1000, 250), changeText(100, 120), changeText(5, 5), changeText(0, 7)]).toEqual(['1 kB → 250 B (−75 %)', '100 B → 120 B (+20 %)', '5 B, as before', '0 B → 7 B']);
  });
  it('has the reflections until the next one that learned', () => {
    const all = decoded(night('30'), night('20', { work: 'forget' }), night('10'));
    expect([untilOf(all, 0), untilOf(all, 1), untilOf(all, 2)]).toEqual([undefined, 30n, 30n]);
  });
  it('that is damaged is refused with a name', () => {
    expect(() => decoded(night('x'))).toThrow("'nights[0].began'");
    expect(() => decoded(night('1', { work: 'sleep' }))).toThrow('one of consolidate, forget');
  });
});

describe('a reflection', () => {
  const finding = { kind: 'gap', severity: 'fault', entity: 'A/B/C/D', member: 'positions[3]', first_snapshot: 'A/B/C/D/1', count: 3, found: 'a pause of 5 s', expected: '50 ms' };
  it('is told in words', () => {
    const found = reflection({ time: '5', findings: [finding, { ...finding, severity: 'note', member: '', count: 1 }] }, '');
    expect(findingsText(found)).toBe('1 fault and 1 note');
    expect(findingsText(reflection({ time: '5', findings: [] }, ''))).toBe('nothing odd was found');
    expect(found.findings.map(findingText)).toEqual(['positions[3]: found a pause of 5 s (3 times), expected 50 ms', 'found a pause of 5 s, expected 50 ms']);
  });
});

describe('a plan', () => {
  it('whose reasons are no counts is refused', () => {
    const plan = { config: 'forget: {}', from: '0', to: '9', bins: 2, plan: {}, entities: [{ id: 'A/B/C/D', reasons: { old: 'many' } }] };
    expect(() => forgetPlan(plan, '')).toThrow("'entities[0].reasons.old'");
    expect(() => forgetPlan({ ...plan, entities: [{ id: 'A/B/C/D', reasons: [1] }] }, '')).toThrow('a dict of counts');
  });
});
