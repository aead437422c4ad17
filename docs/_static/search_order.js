// Order of the site's search: headings and words of the glossary come before text, and the guide before what is generated.
var Scorer = {
  score: ([page, , , , score, , kind]) => {
    const generated = /^generated\/(benchmarks|changelog|contributing|cases)/.test(page);
    return score + (kind === "title" || kind === "index" ? 20 : 0) - (kind === "text" && generated ? 20 : 0);
  },
  objNameMatch: 11,
  objPartialMatch: 6,
  objPrio: { 0: 15, 1: 5, 2: -5 },
  objPrioDefault: 0,
  title: 15,
  partialTitle: 7,
  term: 5,
  partialTerm: 2,
};
