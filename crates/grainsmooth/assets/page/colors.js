// Colours: neighbours never alike, numbers as cividis, all of them told apart by colour-blind readers.

// Okabe and Ito's without black, then grey.
const KINDS = ["#e69f00", "#56b4e9", "#009e73", "#f0e442", "#0072b2", "#d55e00", "#cc79a7", "#999999"].map(channels);

// Cividis at equal steps (Nunez, Anderton and Renslow 2018).
const SCALE = ["#00224e", "#123570", "#3b496c", "#575d6d", "#707173", "#8a8678", "#a59c74", "#c3b369", "#e1cc55", "#fee838"].map(channels);

// Of what has no value.
export const NOTHING = [0.75, 0.75, 0.8];

function channels(text) {
  return [1, 3, 5].map((start) => parseInt(text.slice(start, start + 2), 16) / 255);
}

// Colours for kinds; after the last come darker ones.
export function kind(number) {
  const shade = 0.75 ** Math.floor(number / KINDS.length);
  return KINDS[number % KINDS.length].map((channel) => channel * shade);
}

// The colour of a share from 0 to 1.
export function scale(share) {
  if (!(share >= 0)) return NOTHING;
  const place = Math.min(share, 1) * (SCALE.length - 1);
  const low = Math.min(Math.floor(place), SCALE.length - 2);
  return SCALE[low].map((channel, axis) => channel + (place - low) * (SCALE[low + 1][axis] - channel));
}

export function css(color) {
  return `rgb(${color.map((channel) => Math.round(255 * channel)).join(" ")})`;
}

// The least and the greatest of some numbers.
export function range(values) {
  let low = Infinity, high = -Infinity;
  for (const value of values) {
    if (value === null || Number.isNaN(value)) continue;
    if (value < low) low = value;
    if (value > high) high = value;
  }
  return [low, high];
}

export function share(value, [low, high]) {
  return value === null || Number.isNaN(value) ? NaN : high > low ? (value - low) / (high - low) : 0.5;
}
