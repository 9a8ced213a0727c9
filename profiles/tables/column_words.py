"""What columns and units are called, in the languages that machines are commissioned in."""

from __future__ import annotations

import re

_UNIT_WORDS: dict[str, str] = {
    "m": "m", "mm": "mm", "cm": "cm", "um": "um", "in": "in", "inch": "in", "inches": "in", "ft": "ft",
    "meter": "m", "metre": "m", "millimeter": "mm", "millimetre": "mm", "micron": "um", "microns": "um",
    "米": "m", "毫米": "mm", "厘米": "cm", "微米": "um", "英寸": "in",
    '"': "in", "″": "in", "zoll": "in", "pollici": "in", "pouces": "in", "ミリ": "mm", "mètre": "m", "metri": "m", "metros": "m",
    "rad": "rad", "radian": "rad", "radians": "rad", "弧度": "rad",
    "deg": "deg", "degree": "deg", "degrees": "deg", "°": "deg", "º": "deg", "grad": "deg", "度": "deg",
    "gradi": "deg", "degré": "deg", "degrés": "deg", "grados": "deg",
    "rev": "rev", "revs": "rev", "turn": "rev", "turns": "rev", "umdr": "rev", "转": "rev", "回転": "rev",
    "umdrehung": "rev", "umdrehungen": "rev", "giri": "rev", "giro": "rev", "tours": "rev", "vueltas": "rev",
    "s": "s", "sec": "s", "second": "s", "seconds": "s", "sekunden": "s", "secondi": "s", "secondes": "s", "segundos": "s", "秒": "s",
    "ms": "ms", "msec": "ms", "毫秒": "ms", "ミリ秒": "ms", "us": "us", "微秒": "us",
}  # fmt: skip
"""Words for a unit, and the one name that this house has for it."""

_MEASURES = frozenset({"1", "-", "m/m", "mm/mm", "rad/m", "1/m", "1/mm", "rad/m^2", "1/m^2", "1/mm^2", "rad/m^3"})
_SPACED = re.compile(r"\s*[\[(]?\s*([^\[\]()]*?)\s*[\])]?\s*")
_BRACKETS = re.compile(r"(.*?)\s*(?:\[([^\[\]]*)\]|\(([^()]*)\))\s*")
_SUFFIX = re.compile(r"(.+?)(?:_|\s+in\s+|\s*/\s*|\s*,\s*|\s+)([^\s_/,\[\]()]{1,12})")


_UNSIZED = frozenset(
    {"%", "inc", "incr", "ink", "inkr", "inkremente", "cts", "count", "counts", "pulse", "pulses", "pls", "puu", "uu", "units", "steps",
     "脉冲", "用户单位", "パルス", "impulsi"}
)  # fmt: skip
"""Words for a unit whose size only the machine knows: counts of an encoder, user units, parts of a cycle."""


def is_unsized(text: str) -> bool:
    """Whether a word is a unit whose size only the machine knows."""
    return text.strip().lower().strip(".") in _UNSIZED


def unit_word(text: str) -> str | None:
    """Give the name of a unit, whatever it is called: ``µm`` is ``um``, ``Grad`` is ``deg``; ``None`` for no unit."""
    word = text.strip().rstrip(".").replace("\u00b5", "u").replace("\u03bc", "u")
    found = _UNIT_WORDS.get(word) or _UNIT_WORDS.get(word.lower())
    return found or (word if word in _MEASURES else None)


def bare_unit(cell: str) -> str | None:
    """Give the unit that a cell of a unit row holds, with or without brackets."""
    found = _SPACED.fullmatch(cell)
    return unit_word(found[1]) if found else None


def split_unit(cell: str) -> tuple[str, str | None, bool]:
    """Take a column's name and unit apart.

    Returns
    -------
    (name, unit, known)
        The unit as this house names it, or as it stands in square brackets if it is none; ``known`` says which. Words in
        round brackets that are no unit belong to the name.
    """
    text = cell.strip().strip('"').strip()
    found = _BRACKETS.fullmatch(text)
    if found:
        name, square, rounded = found[1].strip(), found[2], found[3]
        unit = unit_word(square if square is not None else rounded)
        if unit is not None:
            return name, unit, True
        return (name, square.strip(), False) if square is not None else (text, None, True)
    found = _SUFFIX.fullmatch(text)
    if found and (unit := unit_word(found[2])) is not None and not (text == "dy/dx" or unit in ("1", "-")):
        return found[1].strip(), unit, True
    return text, None, True


def words_of(name: str) -> list[str]:
    """Cut a name into words in lower case: at signs, and where small letters meet capitals."""
    parted = re.sub(r"(?<=[a-zäöü0-9])(?=[A-ZÄÖÜ])", " ", name)
    return [word for word in re.split(r"[\s_.\-:/|()\[\]#'\"]+", parted.lower()) if word]


_ROLES: tuple[tuple[str, frozenset[str], tuple[str, ...]], ...] = (
    ("d3y/dx3", frozenset({"d3y/dx3", "j", "y'''"}), ("jerk", "ruck", "jolt", "跃度", "加加速", "躍度")),
    ("d2y/dx2", frozenset({"d2y/dx2", "a", "acc", "accel", "y''"}), ("acc", "beschl", "slaveacc", "acel", "accél", "加速度")),
    ("dy/dx", frozenset({"dy/dx", "v", "vel", "velo", "speed", "ratio", "y'"}),
     ("vel", "geschw", "speed", "vitesse", "速度", "drehzahl", "übersetzung")),
    ("other", frozenset({"torque", "current", "moment", "strom", "error", "lag"}),
     ("torque", "drehm", "schlepp", "电流", "转矩", "误差")),
    ("x", frozenset({"x", "master", "leading", "lead"}), ("master", "leit", "leading", "maître", "maestro", "主轴", "主軸", "マスタ")),
    ("y", frozenset({"y", "slave", "following", "follower"}),
     ("slave", "folge", "follow", "esclav", "asservi", "从轴", "從軸", "従軸", "従動", "スレーブ")),
    ("x", frozenset({"phase", "theta", "phi", "angle", "winkel"}),
     ("theta", "phase", "angle", "winkel", "angol", "ángulo", "fase", "角度", "位相")),
    ("y", frozenset({"s", "position", "pos", "displacement", "hub", "weg", "lift", "corsa", "quota"}),
     ("displ", "posiz", "posici", "spostam", "位移", "位置", "変位")),
    ("index", frozenset({"index", "no", "nr", "n", "i", "point", "pt", "row", "id", "punkt", "punto", "nummer", "序号", "点", "番号"}),
     ("index",)),
)  # fmt: skip
"""Roles of a cam's columns: exact names, and what a word of the name may begin with. The first that fits holds."""

_TRACED: tuple[tuple[str, tuple[str, ...], tuple[str, ...]], ...] = (
    ("lag", ("lag",), ("schlepp", "追従誤差", "跟随误差", "跟踪误差", "偏差")),
    ("other", ("qd", "qdd"), ("velo", "vel", "speed", "geschw", "vitesse", "acc", "beschl", "torque", "tor", "moment", "drehm", "current",
                   "strom", "temper", "error", "err", "diff", "速度", "加速", "电流", "電流", "转矩", "トルク", "误差")),
    ("time", ("t",), ("time", "zeit", "timestamp", "realtime", "时间", "時間", "時刻", "temps", "tempo", "tiempo")),
    ("master", (), ("master", "leit", "leading", "web", "material", "conveyor", "主轴", "主軸", "物料", "マスタ")),
    ("command", ("des",), ("command", "cmd", "set", "soll", "demand", "desired", "reference", "ref", "target", "goal",
                           "指令", "设定", "設定",
                           "目标", "目標", "给定", "comand", "consign", "rifer")),
    ("actual", (), ("actual", "act", "ist", "feedback", "fbk", "fb", "meas", "encoder", "实际", "反馈", "実", "現在", "フィードバック",
                    "attual", "mesur", "misur", "medid", "réel", "reel", "real", "present", "estim")),
)  # fmt: skip
"""Roles of a recording's columns, alike; short names count as words of a longer one too."""

_FOLLOWING = ("followingerror", "positionerror", "poserror", "poserr", "posdiff", "regelabweichung")
"""Names of the lag of the axis, without what stands between their words."""
_COMPOUND = re.compile(r".*(soll|ist)(?:wert|pos|lage|weg|winkel|.?pos)")
"""A word with command or actual inside, as German joins them: ``Lagesollwert``."""


def cam_role(name: str) -> str | None:
    """Say what a column of a cam table is: ``x``, ``y``, a derivative, ``index``, ``other``; ``None`` if its name does not tell."""
    plain = name.strip().lower()
    words = words_of(name)
    for role, names, beginnings in _ROLES:
        if plain in names or any(word.startswith(beginnings) for word in words):
            return role
    short = [role for role, names, _ in _ROLES for word in words if word in names]
    return short[0] if short else None


def trace_role(name: str) -> str | None:
    """Say what a column of a recording is: ``time``, ``master``, ``command``, ``actual``, ``lag``, ``other``; ``None`` if unclear."""
    plain = name.strip().lower().rpartition("/")[2]  # some recorders write where a channel comes from before its name
    words = words_of(name)
    if any(each in "".join(words) for each in _FOLLOWING):
        return "lag"
    if "current" in words and is_position(name):
        return "actual"
    for role, names, beginnings in _TRACED:
        if plain in names or any(word.startswith(beginnings) or (word in names and word != "t") for word in words):
            return role
    inside = next((found[1] for word in words if (found := _COMPOUND.match(word))), None)
    return None if inside is None else {"soll": "command", "ist": "actual"}[inside]


def is_position(name: str) -> bool:
    """Whether a name says that its column is a position, not something else of command or axis."""
    return any(
        word.startswith(("pos", "lage", "weg", "angle", "winkel", "位置", "位移", "変位")) for word in words_of(name)
    )


def is_measured(name: str) -> bool:
    """Whether a name says that its column was measured, not commanded."""
    beginnings = next(beginnings for role, _, beginnings in _TRACED if role == "actual")
    return any(word.startswith(beginnings) for word in words_of(name))
