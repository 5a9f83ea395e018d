// Colours and dashes of curves: distinct for colour-blind readers, and by the dash alone.

/** Custom properties of the style sheet, so that both themes have their own shade. */
export const CURVES = [
  { colour: 'var(--curve-1)', dash: null },
  { colour: 'var(--curve-2)', dash: '7 4' },
  { colour: 'var(--curve-3)', dash: '2 3' },
  { colour: 'var(--curve-4)', dash: '9 3 2 3' },
  { colour: 'var(--curve-5)', dash: '12 4' },
  { colour: 'var(--curve-6)', dash: '9 3 2 3 2 3' },
];
