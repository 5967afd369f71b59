"""Sessions outlive their pages for a while, and not for ever."""

import asyncio

from cdia_pin.app.shelf import MOST, Shelf


class Item:
    closed = False

    def close(self):
        self.closed = True


def test_a_session_waits_for_a_page_that_comes_back():
    async def run():
        shelf = Shelf(Item, kept=0.05)
        key = shelf.begin()
        leave = shelf.show(key)
        await asyncio.sleep(0.1)
        item = shelf.find(key)
        assert item is not None  # a page shows it
        leave()
        again = shelf.show(key)  # as when a page is loaded again
        await asyncio.sleep(0.1)
        assert shelf.find(key) is item and not item.closed
        again()
        await asyncio.sleep(0.1)
        assert shelf.find(key) is None and item.closed

    asyncio.run(run())


def test_of_many_sessions_without_a_page_the_oldest_ends():
    async def run():
        shelf = Shelf(Item)
        shown = shelf.begin()
        shelf.show(shown)
        keys = [shelf.begin() for _ in range(MOST + 2)]
        assert [shelf.find(k) is None for k in keys] == [True, True, *[False] * MOST]
        assert shelf.find(shown) is not None
        items = [shelf.find(k) for k in keys[2:]]
        shelf.close()
        assert all(item.closed for item in items)

    asyncio.run(run())


def test_a_key_that_is_not_known_finds_nothing():
    assert Shelf(Item).find("guessed") is None
