"""What a study varies: `--vary PATH=V1,V2` and `--vary PATH,PATH=V1:W1,V2:W2`, and every combination of them."""

import itertools


class Level:
    """One value of a varied field (or of several that vary together) and the settings that make it."""

    def __init__(self, label, settings, numbers):
        self.label, self.settings = label, settings
        self.numbers = numbers  # of every field; None where one is not a number


class Axis:
    """One --vary: its fields and its levels, in the order given."""

    def __init__(self, paths, levels):
        self.paths, self.levels = paths, levels
        self.name = short_name(paths)

    def sizes(self):
        """Size of what each level resolves, in units of the finest: 1 is the finest, larger is coarser. None where the levels are
        not numbers.

        Whole numbers are taken as counts (more is finer), others as sizes such as a time step (less is finer). Fields that vary
        together count as one: the geometric mean.
        """
        if any(level.numbers is None for level in self.levels):
            return None
        are_counts = all(isinstance(number, int) and number > 0 for level in self.levels for number in level.numbers)
        if not are_counts and any(number <= 0 for level in self.levels for number in level.numbers):
            return None
        sizes = []
        for level in self.levels:
            product = 1.0
            for number in level.numbers:
                product *= 1 / number if are_counts else number
            sizes.append(product ** (1 / len(level.numbers)))
        return [size / min(sizes) for size in sizes]


class Combination:
    """One run: a level of every axis."""

    def __init__(self, axes, indices):
        self.indices = indices
        self.levels = [axis.levels[i] for axis, i in zip(axes, indices)]
        self.settings = [setting for level in self.levels for setting in level.settings]
        self.label = ", ".join(f"{axis.name}={level.label}" for axis, level in zip(axes, self.levels))


def parse_vary(text):
    """An axis from the text behind --vary. Raises ValueError with what is wrong."""
    left, equals, right = text.partition("=")
    paths = [path.strip() for path in left.split(",")]
    if not equals or not right or not all(paths):
        raise ValueError(f"--vary {text}: write PATH=V1,V2,... or PATH,PATH=V1:W1,V2:W2,...")
    levels = []
    for value in split_outside_brackets(right, ","):
        parts = split_outside_brackets(value, ":") if len(paths) > 1 else [value]
        if len(parts) != len(paths):
            raise ValueError(f"--vary {text}: {value} gives {len(parts)} values for {len(paths)} fields; separate them by colons")
        numbers = [as_number(part) for part in parts]
        levels.append(Level(value.strip(), [f"{path}={part.strip()}" for path, part in zip(paths, parts)],
                            None if None in numbers else numbers))
    if len({level.label for level in levels}) < len(levels):
        raise ValueError(f"--vary {text}: a value stands there twice")
    return Axis(paths, levels)


def combine(axes):
    return [Combination(axes, indices) for indices in itertools.product(*(range(len(axis.levels)) for axis in axes))]


def split_outside_brackets(text, separator):
    """Parts of a text; separators inside {}, [], () or quotes do not count."""
    parts, depth, quote = [""], 0, ""
    for character in text:
        if quote:
            quote = "" if character == quote else quote
        elif character in "\"'":
            quote = character
        elif character in "{[(":
            depth += 1
        elif character in "}])":
            depth -= 1
        if character == separator and depth == 0 and not quote:
            parts.append("")
        else:
            parts[-1] += character
    return parts


def as_number(text):
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            pass
    return None


def short_name(paths):
    """The last words of the paths, with what they share written once: elements_x,y,z."""
    ends = [path.rsplit(".", 1)[-1] for path in paths]
    if len(ends) == 1:
        return ends[0]
    shared = ends[0].rsplit("_", 1)[0] + "_"
    if all(end.startswith(shared) for end in ends):
        return shared + ",".join(end[len(shared):] for end in ends)
    return ",".join(ends)
