// SPDX-License-Identifier: Apache-2.0
// Says which locked package would refuse the Node that Debian 12 has. The lock file holds the
// `engines` of every package, so this needs no network and no node_modules.
import { readFileSync } from 'node:fs';

const wanted = [18, 20, 4];

const compare = (a, b) => a[0] - b[0] || a[1] - b[1] || a[2] - b[2];

function parse(text) {
  const parts = text.replace(/^v/, '').split('.').map((part) => Number.parseInt(part, 10));
  return [parts[0], parts[1] || 0, parts[2] || 0];
}

/** True if one comparator such as `>=18.0.0`, `^20.19` or `18` admits the wanted version. */
function admits(comparator) {
  if (comparator === '' || comparator === '*') return true;
  const [, operator, version] = /^(\^|~|>=|<=|>|<|=)?\s*(.+)$/.exec(comparator);
  const bound = parse(version);
  const order = compare(wanted, bound);
  switch (operator) {
    case '>=': return order >= 0;
    case '>': return order > 0;
    case '<': return order < 0;
    case '<=': return order <= 0;
    case '^': return order >= 0 && wanted[0] === bound[0];
    case '~': return order >= 0 && wanted[0] === bound[0] && wanted[1] === bound[1];
    default: return wanted[0] === bound[0];
  }
}

function satisfied(range) {
  return range.split('||').some((part) =>
    part.trim().replace(/(\^|~|>=|<=|>|<|=)\s+/g, '$1').split(/\s+/).every(admits));
}

const lock = JSON.parse(readFileSync(new URL('../package-lock.json', import.meta.url), 'utf8'));
const packages = Object.entries(lock.packages);
const refusing = packages.filter(([, entry]) => entry.engines?.node && !satisfied(entry.engines.node));
const addressed = packages.filter(([, entry]) => entry.resolved !== undefined);
for (const [name, entry] of refusing) console.error(`${name} ${entry.version} needs Node ${entry.engines.node}`);
for (const [name] of addressed) console.error(`${name} has an address in the lock file`);
console.log(`${packages.length} locked packages, Node ${wanted.join('.')}: ${refusing.length} refuse it, ` +
  `${addressed.length} with addresses`);
process.exitCode = refusing.length + addressed.length > 0 ? 1 : 0;
