// Files that are dropped on the page: what each is, by what it holds.

import { shown } from './format.js';
import { BadFile, isEstimates } from './run_data.js';

/** Most that the page reads of a log, bytes. */
const MAX_LOG_BYTES = 512 * 1024 * 1024;

/** The files of a drop, those in its folders too. */
export async function droppedFiles(transfer) {
  // entries are gone once the event has ended: all are taken before anything is waited for
  const entries = [...transfer.items].map((item) => item.webkitGetAsEntry?.()).filter(Boolean);
  const files = [...transfer.files];
  if (!entries.some(({ isDirectory }) => isDirectory)) return files;
  try {
    return (await Promise.all(entries.map(filesOf))).flat();
  } catch (error) {
    throw new BadFile(`the browser does not open this folder (${error.message}): drop the files in it`);
  }
}

/** The files of an entry; folders within a folder are left out, as the command leaves them out. */
async function filesOf(entry) {
  const file = (one) => new Promise((resolve, reject) => { one.file(resolve, reject); });
  if (!entry.isDirectory) return [await file(entry)];
  const reader = entry.createReader();
  const inside = [];
  for (;;) {
    const some = await new Promise((resolve, reject) => { reader.readEntries(resolve, reject); });
    if (!some.length) break;
    inside.push(...some.filter(({ isFile }) => isFile));
  }
  return Promise.all(inside.map(file));
}

/** The files `{robot, columns, scenario, log, table, report}` with those that were opened; several logs are one run. */
export async function withFiles(files, opened) {
  let all = files;
  const logs = [];
  for (const file of opened) {
    const [kind, entry] = await sorted(file);
    if (kind === 'report') return { report: entry };
    if (kind === 'log') logs.push(file);
    else if (kind) all = { ...all, [kind]: entry };
  }
  if (!logs.length) return all;
  const size = logs.reduce((sum, log) => sum + log.size, 0);
  logs.sort((a, b) => a.name.localeCompare(b.name, 'en', { numeric: true }));
  const name = logs.length > 1 ? `${logs[0].name} and ${logs.length - 1} more` : logs[0].name;
  if (size > MAX_LOG_BYTES) throw new BadFile(`${name} has ${shown(size / 1048576)} MiB, but the page reads at most ${MAX_LOG_BYTES / 1048576} MiB: use grouser view ${logs[0].name} --robot …`);
  const { table: _, ...others } = all;
  return { ...others, log: { name, files: logs } };
}

/** What a file is: its kind, and its text where that is read here. */
async function sorted(file) {
  const { name } = file;
  // what a recorder writes beside its recording
  if (/\.ya?ml$/i.test(name)) return [null, null];
  if (/\.toml$/i.test(name)) {
    const text = await file.text();
    const isRobot = /^\s*\[\[wheel/m.test(text) && !/^\s*\[\[column/m.test(text) && /radius/m.test(text);
    return [/^\s*\[(?:\[leg\]|plan)\]/m.test(text) ? 'scenario' : isRobot ? 'robot' : 'columns', { name, text }];
  }
  if (/\.json$/i.test(name)) return ['report', { name, text: await file.text() }];
  if (isEstimates(await file.slice(0, 4096).text())) return ['table', { name, text: await file.text() }];
  return ['log', file];
}
