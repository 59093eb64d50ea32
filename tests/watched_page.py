"""What a page of a real browser asks for and says, for tests of pages that must be quiet."""

from playwright import sync_api


def watched(page: sync_api.Page) -> tuple[list[str], list[str]]:
    """Return lists that fill while the page is used: addresses asked for; messages, errors and dialogs."""
    asked: list[str] = []
    said: list[str] = []

    def dismiss(dialog: sync_api.Dialog) -> None:
        said.append(dialog.message)
        dialog.dismiss()

    page.on("request", lambda request: asked.append(request.url))
    page.on("console", lambda message: said.append(message.text))
    page.on("pageerror", lambda error: said.append(str(error)))
    page.on("dialog", dismiss)
    return asked, said
