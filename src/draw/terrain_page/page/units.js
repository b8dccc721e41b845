// Units and numbers for people. The data are in metres.

function makeUnits({ name, size }) {
  const isFeet = size < 1;
  const number = (value, decimals) => value.toLocaleString(LANGUAGE, { minimumFractionDigits: decimals, maximumFractionDigits: decimals });
  const round = (value) => number(value, value < 10 ? 2 : value < 100 ? 1 : 0);
  return {
    name,
    size,
    number,
    height: (metres, decimals = 1) => `${number(metres / size, decimals)} ${name}`,
    // With its sign. At the limit of colours, the end of a legend stands for all beyond it.
    difference: (metres, limit = Infinity) =>
      `${metres >= limit ? "≥ " : metres <= -limit ? "≤ " : ""}${metres > 0 ? "+" : ""}${number(metres / size, limit < 1 || limit === Infinity ? 2 : limit < 10 ? 1 : 0)} ${name}`,
    length: (metres) => (isFeet || metres < 1000 ? `${round(metres / size)} ${name}` : `${round(metres / 1000)} km`),
    area: (metres) =>
      isFeet ? `${round(metres / 4046.8564224)} acres` : metres < 1e6 ? `${round(metres)} m²` : `${round(metres / 1e6)} km²`,
    volume: (metres) =>
      isFeet ? `${round(metres / 1233.48183754752)} acre-feet` : metres < 1e6 ? `${round(metres)} m³` : metres < 1e9 ? `${round(metres / 1e6)} × 10⁶ m³` : `${round(metres / 1e9)} km³`,
  };
}
