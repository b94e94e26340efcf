"""The loop of a back-end or front-end in Python for evbench (docs/reference/process_protocol.md), to be imported.

    import evbench_process
    hello = evbench_process.hello()             # camera, options, seed, ...
    def take(message): ...                      # returns the answer, a dictionary
    def finish(): ...                           # returns the last answer
    evbench_process.serve("my name", take, finish)
"""
import json, sys

answers, sys.stdout = sys.stdout, sys.stderr  # print() writes to the log, not between the answers

def hello():
    """Reads the opening message of evbench; call it once, before serve()."""
    return json.loads(sys.stdin.readline())

def say(answer): print(json.dumps(answer), file=answers, flush=True)

def serve(name, take, finish):
    """Answers each message by take(message) until there are no more, then by finish()."""
    say({"evbench": 1, "name": name})
    for message in map(json.loads, sys.stdin):
        if "finish" in message: break
        say(take(message))
    say(finish())
