// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import type { Moment } from '../../api/types';
import { followCauses } from './why';

const values: Record<string, unknown> = {
  'Skill/ExecutionRequest/planner/drive/5': { skill: 'kitchen/drive', causes: [{ $link: 'Tasks/Plans/robot/plan/4/0' }, { $link: 'Speech/Commands/human/text/1/0' }] },
  'Tasks/Plans/robot/plan/4': { goal: 'salt on the table', command: { $link: 'Speech/Commands/human/text/1/0' } },
  'Speech/Commands/human/text/1': { text: 'Bring me the salt.', speaker: 'Ada' },
  'Skill/ExecutionRequest/conditions/tidy/8': { skill: 'planner/tidy', causes: [{ $link: 'Objects/Instances/kitchen/juice_1/7/0' }] },
  'Objects/Instances/kitchen/juice_1/7': { is_visible: true },
  'A/B/C/loop/1': { goal: 'itself', cause: { $link: 'A/B/C/loop/1/0' } },
};
const asked: string[] = [];
const load = async (id: string): Promise<Moment | null> => {
  asked.push(id);
  const key = id.replace(/\/0$/, '');
  return key in values ? ({ id: key, time: 0n, source: 'recorded', members: [], instances: [{ index: 0, metadata: {}, data: values[key] }] } as unknown as Moment) : null;
};

describe('why', () => {
  it('leads from a request to what was said, each once', async () => {
    asked.length = 0;
    const steps = await followCauses(['Skill/ExecutionRequest/planner/drive/5/0'], load);
    expect(steps.map((step) => [step.what, step.quote])).toEqual([['planner asked for kitchen/drive', undefined], ['a plan: salt on the table', undefined], ['Ada', 'Bring me the salt.']]);
    expect(asked).toHaveLength(3);
  });
  it('tells the condition, and what met it', async () => {
    expect((await followCauses(['Skill/ExecutionRequest/conditions/tidy/8/0'], load)).map((step) => step.what)).toEqual(['its condition, which starts planner/tidy', 'juice_1']);
  });
  it('ends where links lead in a circle, or to what is gone', async () => {
    expect(await followCauses(['A/B/C/loop/1/0', ''], load)).toHaveLength(1);
    expect((await followCauses(['A/B/C/gone/9/0'], load))[0]!.what).toBe('gone, which is gone');
  });
});
