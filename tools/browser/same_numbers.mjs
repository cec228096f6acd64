// Whether two reports say the same: node same_numbers.mjs COMMITTED FRESH. Words have to be equal, numbers to one unit of their last digit,
// so that another processor's last bit is no difference and another result is one.
import { readFileSync } from "node:fs";

const [committed, fresh] = process.argv.slice(2).map((file) => readFileSync(file, "utf8"));
// A number stands by itself: digits within a word or a hash belong to the word.
const pattern = /(?<![A-Za-z0-9_.])[-\u2212]?\d+(?:\.\d+)?(?![A-Za-z0-9_])|(?<=[A-Za-z])-?\d+(?=[a-zA-Z ]?)/g;
const split = (text) => {
  const numbers = [];
  const words = text.replace(pattern, (number) => { numbers.push(number); return "\u0000"; });
  return { words, numbers };
};
const [a, b] = [split(committed), split(fresh)];
const fail = (why) => { console.error(`${why}\nmake the example anew: tools/example_report`); process.exit(1); };
if (a.words !== b.words) {
  let at = 0;
  while (a.words[at] === b.words[at]) at += 1;
  const near = (text) => JSON.stringify(text.slice(Math.max(0, at - 60), at + 60));
  fail(`the words differ:\n  committed ${near(a.words)}\n  fresh     ${near(b.words)}`);
}
let worst = 0;
a.numbers.forEach((one, k) => {
  const other = b.numbers[k];
  if (one === other) return;
  const value = (text) => Number(text.replace("\u2212", "-"));
  const unit = 10 ** -((one.split(".")[1] ?? "").length);
  const apart = Math.abs(value(one) - value(other)) / unit;
  if (!(apart < 1.5)) fail(`number ${k + 1}: ${one} in the committed report, ${other} now`);
  worst += 1;
});
console.log(`${a.numbers.length} numbers agree, ${worst} of them by one unit of the last digit`);
