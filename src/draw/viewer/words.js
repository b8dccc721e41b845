// What the page says, in English and Japanese.

const ENGLISH = {
  contours: "Contours",
  labels: "Labels",
  hillshade: "Hillshade",
  relief: "3-D terrain",
  exaggeration: "Heights times",
  unit: "Unit",
  metres: "metres",
  feet: "feet",
  none: "none",
  every: (interval, unit) => `every ${interval} ${unit}`,
  closer: "zoom in",
  height: "Height",
  contour: "Contour",
  noHeight: "no height here",
  source: "Source: ",
  help: "Show this map on the web",
  howTo: "This page and the tiles beside it are the whole map. Put the folder on any web server that answers range requests, or start one in the folder:",
  thenOpen: "Then open the address that it names.",
  folders: "Tiles in folders ({z}/{x}/{y}) need no range requests. Every web server will do for them, such as",
  licences: "Licences of the libraries in this page",
  cannot: "The map cannot be shown",
  partly: "A part of the map cannot be shown",
  asFile: "The page was opened as a file. Browsers load no tiles then: it must come from a web server.",
  missing: (name) => `${name} is not in the folder of this page. It was moved, renamed or not uploaded.`,
  noRanges: (name) =>
    `The web server does not answer range requests, so that parts of ${name} cannot be loaded. Use another server, or tiles in a folder.`,
  packed: (name) => `The web server compresses ${name}. It must send .pmtiles as it is, without Content-Encoding.`,
  status: (name, status) => `The web server refuses ${name} (status ${status}).`,
  unreachable: (name) => `${name} cannot be loaded: the web server does not answer.`,
  damaged: (name, cause) => `${name} is damaged or no set of tiles that this page knows: ${cause}`,
  otherContents: (name) => `${name} has neither contours nor heights that this page knows.`,
  noGraphics: "The browser cannot draw the map: it needs WebGL 2.",
  tile: (cause) => `Tiles cannot be loaded: ${cause}`,
  locale: {},
};

const JAPANESE = {
  contours: "等高線",
  labels: "標高の数字",
  hillshade: "陰影",
  relief: "立体表示",
  exaggeration: "高さの倍率",
  unit: "単位",
  metres: "メートル",
  feet: "フィート",
  none: "なし",
  every: (interval, unit) => `${interval} ${unit} 間隔`,
  closer: "拡大すると表示",
  height: "標高",
  contour: "等高線",
  noHeight: "標高データなし",
  source: "出典: ",
  help: "この地図をウェブで公開するには",
  howTo: "このページと同じフォルダのタイルだけで地図になります。レンジリクエストに対応したウェブサーバーにフォルダごと置くか、フォルダの中で次のいずれかを実行してください。",
  thenOpen: "表示されたアドレスをブラウザで開きます。",
  folders: "フォルダ形式のタイル({z}/{x}/{y})にはレンジリクエストは不要で、どのウェブサーバーでも使えます。例:",
  licences: "このページに含まれるライブラリのライセンス",
  cannot: "地図を表示できません",
  partly: "地図の一部を表示できません",
  asFile: "ページがファイルとして開かれています。この場合ブラウザはタイルを読み込めません。ウェブサーバーから開いてください。",
  missing: (name) => `${name} がこのページのフォルダにありません。移動や名前の変更、アップロード漏れを確認してください。`,
  noRanges: (name) =>
    `ウェブサーバーがレンジリクエストに対応していないため、${name} を部分的に読み込めません。別のサーバーかフォルダ形式のタイルを使ってください。`,
  packed: (name) => `ウェブサーバーが ${name} を圧縮して送っています。.pmtiles は Content-Encoding を付けずにそのまま送る必要があります。`,
  status: (name, status) => `ウェブサーバーが ${name} を返しません(ステータス ${status})。`,
  unreachable: (name) => `${name} を読み込めません。ウェブサーバーが応答しません。`,
  damaged: (name, cause) => `${name} は壊れているか、このページで扱えないタイルです: ${cause}`,
  otherContents: (name) => `${name} に、このページで扱える等高線も標高もありません。`,
  noGraphics: "このブラウザでは地図を描画できません。WebGL 2 が必要です。",
  tile: (cause) => `タイルを読み込めません: ${cause}`,
  locale: {
    "NavigationControl.ZoomIn": "拡大",
    "NavigationControl.ZoomOut": "縮小",
    "NavigationControl.ResetBearing": "北を上にする",
    "AttributionControl.ToggleAttribution": "出典の表示",
  },
};

const LANGUAGE = (navigator.languages?.[0] ?? navigator.language ?? "en").toLowerCase().startsWith("ja") ? "ja" : "en";
const WORDS = LANGUAGE === "ja" ? JAPANESE : ENGLISH;

// Commands that serve the folder they are started in.
const WITH_RANGES = ["npx http-server", "caddy file-server --browse --listen :8080", "pip install rangehttpserver && python3 -m RangeHTTPServer"];
const WITHOUT_RANGES = "python3 -m http.server";
