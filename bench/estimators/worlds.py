class Skipped(Exception):
    pass


def logs():
    return []
