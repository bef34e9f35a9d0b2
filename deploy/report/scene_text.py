"""Reads protobuf text (a resolved scene) into nested dictionaries, without the schema."""

import re

TOKEN = re.compile(r'\s+|#[^\n]*|"(?:[^"\\]|\\.)*"|\'(?:[^\'\\]|\\.)*\'|[{}<>\[\]:;,]|[^\s{}<>\[\]:;,"\'#]+')


def parse_scene_text(text):
    """A message is a dictionary; every field holds the list of its values in order."""
    tokens = [token for token in TOKEN.findall(text) if not token.isspace() and not token.startswith("#")]
    message, _ = _parse_fields(tokens, 0)
    return message


def _parse_fields(tokens, at):
    message = {}
    while at < len(tokens) and tokens[at] not in ("}", ">"):
        name = tokens[at]
        at += 1
        if at < len(tokens) and tokens[at] == ":":
            at += 1
        values, at = _parse_values(tokens, at)
        message.setdefault(name, []).extend(values)
        while at < len(tokens) and tokens[at] in (";", ","):
            at += 1
    return message, at


def _parse_values(tokens, at):
    if at >= len(tokens):
        return [], at
    if tokens[at] == "[":
        values, at = [], at + 1
        while at < len(tokens) and tokens[at] != "]":
            more, at = _parse_values(tokens, at)
            values += more
            at += at < len(tokens) and tokens[at] == ","
        return values, at + 1
    if tokens[at] in ("{", "<"):
        message, at = _parse_fields(tokens, at + 1)
        return [message], at + 1
    return [_scalar(tokens[at])], at + 1


def _scalar(token):
    if token[0] in "\"'":
        return token[1:-1].replace("\\\"", "\"").replace("\\'", "'").replace("\\\\", "\\")
    if token in ("true", "false"):
        return token == "true"
    try:
        return int(token)
    except ValueError:
        pass
    try:
        return float(token)
    except ValueError:
        return token


def find(message, path, default=None):
    """The first value at a path such as `flow.glottis.model`; `default` where there is none."""
    for name in path.split("."):
        if not isinstance(message, dict) or not message.get(name):
            return default
        message = message[name][0]
    return message


def leaves(message, path=""):
    """Every scalar with its path: (`solid.body[0].name`, value)."""
    for name, values in message.items():
        for i, value in enumerate(values):
            place = f"{path}{name}" + (f"[{i}]" if len(values) > 1 else "")
            if isinstance(value, dict):
                yield from leaves(value, place + ".")
            else:
                yield place, value
