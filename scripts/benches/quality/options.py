"""Types of command-line options."""

import argparse


def words(text):
    return text.split(",")


def counts(text):
    try:
        found = [int(word) for word in text.split(",")]
    except ValueError:
        found = []
    if not found or min(found) < 1:
        raise argparse.ArgumentTypeError(f"'{text}': expected counts such as 1,4,16")
    return found


def frames(text):
    first, _, last = text.partition("-")
    if not (first.isdigit() and last.isdigit() and int(first) <= int(last)):
        raise argparse.ArgumentTypeError(f"'{text}': expected a range such as 1-16")
    return list(range(int(first), int(last) + 1))
