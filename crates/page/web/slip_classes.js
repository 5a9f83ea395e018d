// Slip in classes, each with a colour.

/** Upper limits of the classes. */
export const SLIP_CLASSES = [0.05, 0.1, 0.2, 0.35, 0.6, Infinity];

/** The class of a slip; −1 where none is known. */
export function slipClass(slip) {
  if (!Number.isFinite(slip)) return -1;
  return SLIP_CLASSES.findIndex((limit) => Math.abs(slip) < limit);
}
