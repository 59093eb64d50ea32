"""Remake published tables, pictures and data files.

python benchmarks/make.py                    list the topics: what each shows, where, how long it takes
python benchmarks/make.py geometry scenes    run these, and write the tables of all pages from their data
python benchmarks/make.py --all              run all of them (about five hours)
python benchmarks/make.py --tables           run nothing, only write the tables
python benchmarks/make.py --toy --out DIR    run at toy size, in seconds, elsewhere than in results/
"""

import argparse
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
if not __package__:  # run as a script: its checkout holds the package `benchmarks`
    sys.path[0] = str(ROOT)


def main(arguments: list[str] | None = None) -> None:
    """Do what the command line asks for."""
    from benchmarks.pages import write_pages
    from benchmarks.published import recording, shrink_pictures
    from benchmarks.topic import RESULTS
    from benchmarks.topics import TOPICS

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("topics", nargs="*", metavar="TOPIC", help=", ".join(TOPICS))
    parser.add_argument("--all", action="store_true", help="every topic")
    parser.add_argument("--list", action="store_true", help="list the topics and run nothing")
    parser.add_argument("--tables", action="store_true", help="write the tables of all pages and run nothing")
    parser.add_argument("--toy", action="store_true", help="toy size, which needs --out")
    parser.add_argument("--out", type=Path, default=RESULTS, help="folder of the results")
    asked = parser.parse_args(arguments)
    if unknown := set(asked.topics) - TOPICS.keys():
        parser.error(f"no topic {', '.join(sorted(unknown))}; there are {', '.join(TOPICS)}")
    if asked.toy and asked.out.resolve() == RESULTS:
        parser.error("--toy needs --out: published results are of full size")
    chosen = list(TOPICS) if asked.all else asked.topics
    if asked.list or not (chosen or asked.tables):
        for name, topic in TOPICS.items():
            print(f"{name:20s}{topic.takes:>8s}  results/{topic.folder:20s}{topic.shows}")
        return
    for name in chosen:
        topic, folder = TOPICS[name], asked.out / TOPICS[name].folder
        folder.mkdir(parents=True, exist_ok=True)
        print(f"--- {name}: {topic.shows}", flush=True)
        with recording(asked.out, name, topic.folder):
            topic.run(folder, **(topic.toy if asked.toy else {}))
            shrink_pictures(folder)
        if asked.out.resolve() != RESULTS:
            print(*(table(folder) for table in topic.tables.values()), sep="\n\n")
    if asked.out.resolve() == RESULTS:
        write_pages(TOPICS)


if __name__ == "__main__":
    main()
