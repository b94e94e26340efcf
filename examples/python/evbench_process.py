"""The loop of a back-end or front-end in Python for evbench (core/process/protocol.md), to be imported.

    import evbench_process
    hello = evbench_process.hello()             # camera, options, seed, ...
    def take(message): ...                      # returns the answer, a dictionary
    def finish(): ...                           # likewise the last one
    evbench_process.serve("my name", take, finish)
"""
import json, sys

answers, sys.stdout = sys.stdout, sys.stderr  # so that print() writes to the log, and not between the answers

def hello():
    """What evbench says first; to be called once, before serve()."""
    return json.loads(sys.stdin.readline())

def say(answer): print(json.dumps(answer), file=answers, flush=True)

def serve(name, take, finish):
    """Answers each message by take(message) until there are no more, then by finish()."""
    say({"evbench": 1, "name": name})
    for message in map(json.loads, sys.stdin):
        if "finish" in message: break
        say(take(message))
    say(finish())
